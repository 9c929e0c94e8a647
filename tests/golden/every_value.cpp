#include "tests/golden/every_value.hpp"

#include <algorithm>
#include <limits>

namespace kinship::test {
namespace {

Source every_source(Distinct& next, Relation relation) {
  Source source;
  source.robot = next.id<Digest>();
  source.label = next.name("label");
  source.paths = next.count();
  source.generation = next.count();
  source.poses = next.count();
  source.poses_solved = next.count();
  source.relation = relation;
  source.paths_used = next.count();
  source.out_of_reach = next.count();
  source.outside_limits = next.count();
  source.not_converged = next.count();
  source.configurations = next.count();
  source.mass = next.share();
  source.colliding = next.count();
  source.tracks_tried = next.count();
  source.tracks_kept = next.count();
  source.random_configurations = next.count();
  source.filter_checks = next.count();
  source.self_collisions = next.count();
  source.scene_collisions = next.count();
  source.paths_with_scene = next.count();
  source.tracks_through = next.count();
  source.poses_on_tracks = 10'000 + source.tracks_through;
  return source;
}

Advice every_advice(Distinct& next) {
  Advice advice;
  advice.recommended_share = next.share();
  advice.guided_share = next.share();
  advice.evidence = next.text("evidence");
  advice.guided = every_evidence(next);
  advice.control = every_evidence(next);
  advice.recent = {
      {.sampling_mode = SamplingMode::Control,
       .solved = true,
       .checks = next.count(),
       .age = 9,
       .time_s = 9.375},
      {.sampling_mode = SamplingMode::Guided,
       .solved = false,
       .checks = next.count(),
       .age = 4,
       .time_s = 4.375},
  };
  return advice;
}

Eigen::MatrixXd covariance(Distinct& next) {
  const Eigen::MatrixXd factor = next.matrix(kJoints, kJoints).triangularView<Eigen::Lower>();
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(kJoints, kJoints);
  for (Eigen::Index row = 0; row < kJoints; ++row)
    for (Eigen::Index column = 0; column <= row; ++column) {
      product(row, column) = factor(row, column) + (row == column ? 2 : 0);
      product(column, row) = product(row, column);
    }
  return product;
}

/// One coordinate without bounds, two with one.
TaskSpaceRegion every_region() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Distinct next(250);
  TaskSpaceRegion region{next.pose(), next.pose()};
  region.bounds = next.matrix(2, 6);
  region.bounds(0, 0) = region.bounds(0, 1) = -kInfinity;
  region.bounds(1, 0) = region.bounds(1, 2) = kInfinity;
  return region;
}

}  // namespace

ModeEvidence every_evidence(Distinct& next) {
  ModeEvidence evidence;
  evidence.solved = next.count();
  evidence.attempts = next.count();
  evidence.checks_per_solution = next.real();
  return evidence;
}

PlanningRecord every_record(Distinct& next) {
  PlanningRecord record;
  record.outcome = Outcome::Solved;
  record.planner = next.text("planner");
  record.planner_options = next.text("options");
  record.planning_time_s = next.real();
  record.collision_checks = next.count();
  record.projections = next.count();
  record.time_limit_s = next.real();
  record.sampling_mode = SamplingMode::Control;
  record.share = next.share();
  record.distribution_id = next.id<Digest>();
  record.distribution_revision = next.count();
  record.processor_time_s = 10'000 + record.planning_time_s;
  record.machine_speed = 20'000 + record.planning_time_s;
  record.hand_length_m = 30'000 + record.planning_time_s;
  record.least_clearance_m = 40'000 + record.planning_time_s;
  return record;
}

RobotDescription every_robot_description() {
  Distinct next(100);
  RobotDescription robot;
  robot.label = next.name("label");
  robot.urdf = next.text("<robot>\n\t\"") + "</robot>";
  robot.base_link = next.name("base");
  robot.tip_link = next.name("tip");
  robot.T_tip_transfer = next.pose();
  robot.task_axes.matters = {true, false, true, true, false, true};
  robot.held_joints = {{next.name("joint"), next.real()}, {next.name("joint"), -next.real()}};
  robot.never_colliding = {{next.name("link"), next.name("link")},
                           {next.name("link"), next.name("link")}};
  robot.mesh_solids.solids = {
      {next.name("link"), BoxShape{{next.real(), next.real(), next.real()}}, next.pose()},
      {next.name("link"), CapsuleShape{next.real(), next.real()}, next.pose()}};
  robot.mesh_solids.unfiltered = {{next.name("link"), next.name("link")}};
  robot.meshes = {{next.name("link"), MeshRole::Both, next.pose(), {}, 0, next.id<Digest>()},
                  {next.name("link"),
                   MeshRole::Visual,
                   next.pose(),
                   {0.25, 0.5, 0.75, 1},
                   next.real(),
                   next.id<Digest>()}};
  return robot;
}

RecordedScene every_recorded_scene() {
  Distinct next(200);
  RecordedScene scene;
  scene.objects = {
      {next.name("box"), BoxShape{{next.real(), next.real(), next.real()}}, next.pose()},
      {next.name("cylinder"), CylinderShape{next.real(), next.real()}, next.pose()},
      {next.name("sphere"), SphereShape{next.real()}},
      {next.name("capsule"), CapsuleShape{next.real(), next.real()}, next.pose()}};
  scene.objects[2].T_task_object.translation() << 1, 2, 3;
  scene.held = {{next.name("held"), SphereShape{next.real()}, next.pose()}};
  scene.allowed_collisions = {{scene.held[0].name, scene.objects[0].name},
                              {scene.objects[1].name, scene.objects[3].name}};
  scene.constraint = every_region();
  return scene;
}

SearchRecord every_search_record() {
  Distinct next(3400);
  SearchRecord search;
  search.start = next.matrix(kJoints, 1);
  search.goals = next.matrix(kJoints, 2);
  search.T_task_start = next.pose();
  search.T_task_goal = next.pose();
  for (int i = 0; i < 2; ++i)
    search.blockers.push_back({next.name("link"), next.name("object"), next.count()});
  search.goal_contacts = {{1, next.name("link"), next.name("object")}};
  search.last_free = next.matrix(kJoints, 1);
  search.trees = {{next.matrix(kJoints, 3).cast<float>(), {-1, 0, 1}},
                  {next.matrix(kJoints, 2).cast<float>(), {-1, -1}}};
  search.allowed_collisions = {{next.name("link"), next.name("held")}};
  search.seed = next.count();
  search.reason = next.text("reason");
  return search;
}

Attempt every_attempt() {
  Distinct next(300);
  Attempt attempt;
  attempt.report_uuid = next.id<Uuid>();
  attempt.robot = next.id<Digest>();
  attempt.machine = next.text("Halle Süd");
  attempt.task = next.name("task");
  attempt.T_task_base = next.pose();
  attempt.record = every_record(next);
  attempt.path = Path(next.matrix(kJoints, 3));
  attempt.scene = every_recorded_scene();
  attempt.search = every_search_record();
  return attempt;
}

Attempt every_unsolved_attempt() {
  Attempt attempt = every_attempt();
  attempt.T_task_base.reset();
  attempt.record.outcome = Outcome::Timeout;
  attempt.record.sampling_mode = SamplingMode::Uniform;
  attempt.record.distribution_id.reset();
  attempt.path.reset();
  attempt.scene.reset();
  attempt.search.reset();
  return attempt;
}

Selection every_selection() {
  Distinct next(400);
  Selection selection;
  selection.sources = {next.id<Digest>(), next.id<Digest>()};
  std::sort(selection.sources.begin(), selection.sources.end());
  selection.weighting = Weighting::Paths;
  selection.since_ms = next.time_ms();
  return selection;
}

Distribution every_distribution() {
  Distinct next(500);
  Distribution distribution;
  distribution.id = next.id<Digest>();
  distribution.revision = next.count();
  distribution.store_epoch = next.id<Uuid>();
  distribution.task = next.name("task");
  distribution.robot = next.id<Digest>();
  distribution.T_task_base = next.pose();
  distribution.profile = next.name("profile");
  distribution.selection = every_selection();
  distribution.engines = next.text("engines");
  distribution.state = DistributionState::Thin;
  distribution.reason = next.text("reason");
  distribution.sources = {every_source(next, Relation::SameArm),
                          every_source(next, Relation::Identical)};
  distribution.configurations = next.count();
  const Eigen::MatrixXd means = next.matrix(kJoints, 2);
  distribution.mixture =
      Mixture(Eigen::Vector2d(0.375, 0.625), means, {covariance(next), covariance(next)});
  distribution.limits.resize(2, kJoints);
  distribution.limits.row(0) = -next.matrix(1, kJoints);
  distribution.limits.row(1) = next.matrix(1, kJoints);
  distribution.held_out_score = -next.real();
  distribution.advice = every_advice(next);
  distribution.fitted_ms = next.time_ms();
  distribution.transfer_time_s = next.real();
  distribution.fit_time_s = next.real();
  distribution.component_scores = {{90, -next.real()}, {7, -next.real()}};
  distribution.cuts = {std::nullopt, next.share(), std::nullopt, next.share()};
  distribution.fit = FitOrigin{.from_revision = 9,
                               .full_revision = 6,
                               .paths = 525,
                               .new_paths = 25,
                               .transferred = 26,
                               .reason = next.text("reason")};
  distribution.filters = next.text("filters");
  return distribution;
}

Distribution every_kernels() {
  Distinct next(800);
  Distribution kernels = every_distribution();
  kernels.state = DistributionState::Ready;
  const Eigen::MatrixXd of_all =
      covariance(next);  // first: compilers differ in the order of arguments
  // f32 is exact for such means, as the wire has them
  kernels.mixture = Mixture(Eigen::Vector3d(0.25, 0.125, 0.625), next.matrix(kJoints, 3), {of_all});
  return kernels;
}

Distribution every_failure() {
  Distribution failed = every_distribution();
  failed.T_task_base.reset();
  failed.selection = {};
  failed.state = DistributionState::Failed;
  failed.sources.clear();
  failed.mixture.reset();
  failed.limits.resize(2, 0);
  failed.held_out_score.reset();
  failed.advice.guided.reset();
  failed.advice.control.reset();
  failed.advice.recent.clear();
  failed.component_scores.clear();
  failed.cuts.clear();
  failed.fit.reset();
  return failed;
}

Announcement every_announcement() {
  Distinct next(2300);
  Announcement announcement;
  announcement.distribution_id = next.id<Digest>();
  announcement.task = next.name("task");
  announcement.robot = next.id<Digest>();
  announcement.revision = next.count();
  announcement.store_epoch = next.id<Uuid>();
  return announcement;
}

Event every_event() {
  Distinct next(2400);
  Event event;
  event.kind = EventKind::Refusal;
  event.time_ms = next.time_ms();
  event.task = next.name("task");
  event.robot = next.name("robot");
  event.text = next.text("text");
  return event;
}

RegisterReply every_register_reply() {
  Distinct next(2500);
  RegisterReply reply;
  reply.status = RegisterStatus::Known;
  reply.robot = next.id<Digest>();
  reply.dof = 7;
  reply.solver = next.text("solver");
  reply.message = next.text("message");
  reply.same_arms = {next.name("label"), next.name("label")};
  reply.geometry_grade = GeometryGrade::Approximate;
  reply.took_geometry = true;
  reply.geometry = next.text("geometry");
  reply.retry_after = std::chrono::milliseconds(next.count());
  reply.wanted = {{next.id<Digest>()}, {next.id<Digest>()}};
  reply.meshes = next.text("meshes");
  return reply;
}

ReportRequest every_report_request() {
  ReportRequest request;
  request.attempts = {every_attempt(), every_unsolved_attempt()};
  request.known_token = {3, 1, 4, 1, 5};
  return request;
}

ReportReply every_report_reply() {
  Distinct next(2600);
  ReportReply reply;
  reply.store_epoch = next.id<Uuid>();
  for (const ReceiptStatus status : {ReceiptStatus::Refused, ReceiptStatus::TryAgain}) {
    Receipt receipt;
    receipt.report_uuid = next.id<Uuid>();
    receipt.status = status;
    receipt.message = next.text("message");
    reply.receipts.push_back(receipt);
  }
  reply.consistency_token = {2, 7, 1, 8};
  reply.retry_after = std::chrono::milliseconds(next.count());
  reply.message = next.text("message");
  return reply;
}

FetchRequest every_fetch_request() {
  Distinct next(2700);
  FetchRequest request;
  request.task = next.name("task");
  request.robot = next.id<Digest>();
  request.T_task_base = next.pose();
  request.profile = next.name("profile");
  request.minimum_generation = next.count();
  request.deadline = std::chrono::milliseconds(next.count());
  request.selection = every_selection();
  request.follow = std::chrono::seconds(next.count());
  request.experience_bytes = static_cast<std::uint32_t>(next.count());
  request.known_experience = next.count();
  request.rehearsed = true;
  request.known_recall = next.count();
  request.start = {next.real(), -next.real()};
  request.T_task_goal = next.pose();
  request.to_configuration = true;
  return request;
}

TaskExperience every_experience() {
  Distinct next(3100);
  TaskExperience experience;
  experience.revision = next.count();
  experience.paths_known = next.count();
  for (int i = 0; i < 2; ++i)
    experience.paths.push_back(
        {next.id<Digest>(), next.id<Uuid>(), {next.pose(), next.pose(), next.pose()}});
  return experience;
}

Rehearsal every_rehearsal() {
  Distinct next(3200);
  Rehearsal rehearsal;
  rehearsal.guide = Guide::WaysMixture;
  rehearsal.is_complete = true;
  rehearsal.queries = next.count();
  rehearsal.left_out = next.count();
  rehearsal.processor_time_s = next.real();
  for (const Guide guide : {Guide::Retreat, Guide::RetreatWaysMixture}) {
    GuideCost cost{.guide = guide};
    cost.solved = next.count();
    cost.plans = next.count();
    cost.mean_checks = next.real();
    cost.median_checks = next.real();
    cost.mean_time_s = next.real();
    rehearsal.costs.push_back(cost);
  }
  rehearsal.message = next.text("message");
  return rehearsal;
}

RecallLibrary every_library() {
  constexpr Eigen::Index kDof = 2;
  Distinct next(3300);
  RecallLibrary library;
  library.revision = next.count();
  library.search_checks = next.real();
  library.anchors = {next.name("anchor"), next.name("anchor")};
  for (const bool is_synthetic : {false, true})
    library.queries.push_back({.report = next.id<Uuid>(),
                               .is_synthetic = is_synthetic,
                               .T_task_base = next.pose(),
                               .start = next.matrix(kDof, 1),
                               .goal = next.matrix(kDof, 1),
                               .T_task_anchors = {next.pose(), next.pose()}});
  for (const std::uint32_t query : {1U, 0U, 1U})
    library.paths.push_back({query, next.matrix(kDof, kRecallWaypoints)});
  library.modes = {{2, kGoalFrame}, {1, kFirstAnchor + 1}};
  library.solves = {0b1010'0110, 0b0101};
  library.reaches = {0b1110'0111, 0b1101};
  library.try_checks = next.real();
  return library;
}

FetchReply every_fetch_reply() {
  Distinct next(2800);
  FetchReply reply;
  reply.status = FetchStatus::Ready;
  reply.distribution = every_distribution();
  reply.retry_after = std::chrono::milliseconds(next.count());
  reply.message = next.text("message");
  reply.experience = every_experience();
  reply.rehearsal = every_rehearsal();
  reply.recall = every_library();
  return reply;
}

AdminRequest every_admin_request() {
  Distinct next(2900);
  AdminRequest request;
  request.verb = AdminVerb::ShowJob;
  request.argument = next.text("argument");
  request.robot = next.name("robot");
  request.task = next.name("task");
  request.cursor = next.text("cursor");
  request.limit = 321;
  request.deadline = std::chrono::milliseconds(next.count());
  request.proof = next.text("proof");
  return request;
}

AdminReply every_admin_reply() {
  Distinct next(3000);
  AdminReply reply;
  reply.status = AdminStatus::Failed;
  reply.rows = {next.text("row"), next.text("row")};
  reply.next_cursor = next.text("cursor");
  reply.message = next.text("message");
  reply.last_row_continues = true;
  reply.retry_after = std::chrono::milliseconds(next.count());
  return reply;
}

}  // namespace kinship::test
