// Of every_value.hpp: the rows that verbs list, and what planners read and answer.

#include <limits>

#include "tests/golden/every_value.hpp"

namespace kinship::test {
namespace {

Problem problem_without_goal(Distinct& next) {
  Problem problem;
  problem.name = next.name("problem");
  problem.T_task_base = next.pose();
  problem.start = next.matrix(kJoints, 1);
  problem.scene.objects = {
      {next.name("box"), BoxShape{{next.share(), next.share(), next.share()}}, next.pose()},
      {next.name("cylinder"), CylinderShape{next.share(), next.share()}, next.pose()},
      {next.name("sphere"), SphereShape{next.share()}},
      {next.name("capsule"), CapsuleShape{next.share(), next.share()}, next.pose()}};
  problem.scene.objects[2].T_task_object.translation() << 1, 2, 3;
  problem.scene.meshes = {{next.name("mesh"), {next.text("file"), {1, 2, -3}}, next.pose()}};
  problem.scene.clouds = {{next.name("cloud"), {next.text("file"), next.share()}, next.pose()}};
  problem.attached = {{next.name("held"),
                       next.name("link"),
                       CylinderShape{next.share(), next.share()},
                       next.pose(),
                       {next.name("touch"), next.name("touch")}},
                      {next.name("held"),
                       next.name("link"),
                       {},
                       next.pose(),
                       {},
                       Mesh{next.text("file"), {4, 5, 6}}}};
  problem.allowed_collisions = {{next.name("first"), next.name("second")}};
  problem.constraint = TaskSpaceRegion{next.pose(), next.pose()};
  problem.constraint->bounds.row(0) << -1, -2, -std::numeric_limits<double>::infinity(), -0.5,
      -0.25, -0.125;
  problem.constraint->bounds.row(1) << 1.5, 2.5, std::numeric_limits<double>::infinity(), 0.75,
      0.375, 0.1875;
  problem.time_limit_s = next.real();
  problem.seed = next.count();
  return problem;
}

}  // namespace

RobotSummary every_robot_summary() {
  Distinct next(900);
  RobotSummary robot;
  robot.robot = next.id<Digest>();
  robot.label = next.name("label");
  robot.base_link = next.name("base");
  robot.tip_link = next.name("tip");
  robot.dof = next.count32();
  robot.solver = next.text("solver");
  robot.paths = next.count();
  robot.attempts = next.count();
  robot.registered_ms = next.time_ms();
  robot.geometry = next.text("geometry");
  robot.geometry_ms = next.time_ms();
  return robot;
}

TaskSummary every_task_summary() {
  Distinct next(1000);
  TaskSummary task;
  task.task = next.name("task");
  task.paths = next.count();
  task.attempts = next.count();
  for (int i = 0; i < 2; ++i) {
    TaskRobotSummary robot;
    robot.robot = next.id<Digest>();
    robot.label = next.name("label");
    robot.paths = next.count();
    robot.attempts = next.count();
    robot.generation = next.count();
    task.robots.push_back(robot);
  }
  task.dropped = next.count();
  for (TaskRobotSummary& robot : task.robots)
    robot.dropped = next.count();
  for (TaskRobotSummary& robot : task.robots) {
    robot.guided = ModeEvidence{next.count(), next.count(), next.real()};
    robot.control = ModeEvidence{next.count(), next.count(), next.real()};
  }
  return task;
}

PathSummary every_path_summary() {
  Distinct next(1100);
  PathSummary path;
  path.report_uuid = next.id<Uuid>();
  path.robot = next.id<Digest>();
  path.label = next.name("label");
  path.task = next.name("task");
  path.machine = next.text("machine");
  path.T_task_base = next.pose();
  path.record = every_record(next);
  path.waypoints = next.count();
  path.length = next.real();
  path.received_ms = next.time_ms();
  path.retired_ms = next.time_ms();
  path.dropped = true;
  return path;
}

AttemptSummary every_attempt_summary() {
  Distinct next(1150);
  AttemptSummary attempt;
  attempt.report_uuid = next.id<Uuid>();
  attempt.robot = next.id<Digest>();
  attempt.label = next.name("label");
  attempt.task = next.name("task");
  attempt.machine = next.text("machine");
  attempt.record = every_record(next);
  attempt.received_ms = next.time_ms();
  return attempt;
}

DistributionSummary every_distribution_summary() {
  Distinct next(1200);
  DistributionSummary distribution;
  distribution.id = next.id<Digest>();
  distribution.revision = next.count();
  distribution.task = next.name("task");
  distribution.robot = next.id<Digest>();
  distribution.label = next.name("label");
  distribution.profile = next.name("profile");
  distribution.state = DistributionState::Thin;
  distribution.reason = next.text("reason");
  distribution.components = next.count();
  distribution.configurations = next.count();
  distribution.paths = next.count();
  distribution.fitted_ms = next.time_ms();
  distribution.T_task_base = next.pose();
  distribution.selection = {{next.id<Digest>()}, Weighting::Paths, next.time_ms()};
  return distribution;
}

Explanation every_explanation() {
  Distinct next(1300);
  Explanation explanation;
  explanation.distribution = every_distribution();
  explanation.distribution.mixture.reset();
  for (int i = 0; i < 2; ++i) {
    Explanation::Now now;
    now.robot = next.id<Digest>();
    now.label = next.name("label");
    now.paths = next.count();
    now.generation = next.count();
    explanation.experience.push_back(now);
  }
  explanation.behind = true;
  explanation.next_fit = next.text("next fit");
  explanation.rehearsal = every_rehearsal();
  return explanation;
}

Retirement every_retirement() {
  Distinct next(1400);
  Retirement retirement;
  retirement.task = next.name("task");
  retirement.paths = next.count();
  retirement.robots = {next.id<Digest>(), next.id<Digest>()};
  return retirement;
}

RobotRemoval every_robot_removal() {
  Distinct next(1450);
  RobotRemoval removal;
  removal.robot = next.id<Digest>();
  removal.label = next.name("label");
  removal.paths = next.count();
  removal.attempts = next.count();
  removal.distributions = next.count();
  removal.is_deleted = true;
  return removal;
}

Job every_job() {
  Distinct next(1500);
  Job job;
  job.id = next.name("id");
  job.verb = next.text("verb");
  job.argument = next.text("argument");
  job.state = JobState::Cancelled;
  job.progress = next.share();
  job.message = next.text("message");
  job.rows = next.count();
  job.started_ms = next.time_ms();
  job.ended_ms = next.time_ms();
  return job;
}

ClientUse every_client_use() {
  Distinct next(1550);
  ClientUse use;
  use.client = next.name("client");
  use.robots = {next.name("label"), next.name("label")};
  use.attempts_per_s = next.real();
  use.bytes_per_s = next.real();
  use.on_way = next.count();
  use.waiting = next.count();
  use.leases = next.count();
  use.fits = next.count();
  use.attempts = next.count();
  use.registered_robots = next.count();
  use.created_tasks = next.count();
  use.stored_bytes = next.count();
  use.refused = next.count();
  use.refused_for = next.text("quota");
  use.last_seen_ms = next.time_ms();
  return use;
}

BackupSummary every_backup() {
  Distinct next(1580);
  BackupSummary backup;
  backup.name = next.name("name");
  backup.bytes = next.count();
  backup.modified_ms = next.time_ms();
  return backup;
}

AuditEntry every_audit_entry() {
  Distinct next(1650);
  AuditEntry entry;
  entry.number = next.count();
  entry.time_ms = next.time_ms();
  entry.name = next.name("name");
  entry.role = next.name("role");
  entry.client = next.text("client");
  entry.is_local = false;
  entry.verb = next.name("verb");
  entry.target = next.text("target");
  entry.outcome = AuditOutcome::Refused;
  entry.before = next.text("before");
  entry.after = next.text("after");
  entry.message = next.text("message");
  return entry;
}

ServerStatus every_status() {
  Distinct next(1600);
  ServerStatus status;
  status.version = next.text("version");
  status.store_file = next.text("file");
  status.store_epoch = next.id<Uuid>();
  status.schema_version = next.count32();
  status.uptime_s = next.count();
  status.robots = next.count();
  status.tasks = next.count();
  status.paths = next.count();
  status.attempts = next.count();
  status.distributions = next.count();
  status.reports_received = next.count();
  status.reports_refused = next.count();
  status.fetches = next.count();
  status.fetches_from_memory = next.count();
  status.fits = next.count();
  status.queued_reports = next.count();
  status.queued_fits = next.count();
  status.followed = next.count();
  status.jobs = next.count();
  status.store_bytes = next.count();
  status.writable = false;
  status.storage_message = next.text("message");
  status.rehearsals = next.count();
  status.queued_rehearsals = next.count();
  status.rehearsal_time_s = next.real();
  status.rollbacks = next.count();
  status.scrubbed_ms = next.time_ms();
  status.scrub_part = next.real();
  for (int i = 0; i < 2; ++i) {
    TroubleCount trouble;
    trouble.what = next.text("trouble");
    trouble.count = next.count();
    trouble.last = next.text("last");
    trouble.last_ms = next.time_ms();
    status.troubles.push_back(trouble);
    BoundUse bound;
    bound.what = next.text("bound");
    bound.used = next.count();
    bound.limit = next.count();
    status.bounds.push_back(bound);
  }
  status.dropped_paths = next.count();
  status.credentials_expire_ms = next.time_ms();
  for (int i = 0; i < 2; ++i)
    status.replicas.push_back({.host = next.text("host"),
                               .readings = next.count(),
                               .behind = next.count(),
                               .failed = next.count(),
                               .message = next.text("message")});
  return status;
}

StoreCheck every_store_check() {
  Distinct next(1700);
  StoreCheck check;
  check.file = next.text("file");
  check.epoch = next.id<Uuid>();
  check.schema_version = next.count32();
  check.bytes = next.count();
  for (int i = 0; i < 2; ++i) {
    StoreCheck::Table table;
    table.name = next.name("table");
    table.rows = next.count();
    table.problems = next.count();
    check.tables.push_back(table);
  }
  check.damaged_paths = next.count();
  check.retired_paths = next.count();
  check.problems = next.count();
  check.messages = {next.text("message"), next.text("message")};
  return check;
}

CredentialList every_credential_list() {
  Distinct next(3300);
  CredentialList list;
  list.authorities.push_back({next.text("authority"), next.name("fingerprint"), next.time_ms()});
  CredentialList::Row row;
  row.name = next.name("name");
  row.role = next.name("role");
  row.tasks = {next.name("task"), next.name("task")};
  row.robots = {next.name("robot"), next.name("robot")};
  row.state = next.text("state");
  row.expires_ms = next.time_ms();
  row.days_left = static_cast<std::int64_t>(next.count());
  row.revoked_ms = next.time_ms();
  row.authority = next.name("fingerprint");
  row.is_of_previous_authority = true;
  row.message = next.text("message");
  row.trusted = {next.name("fingerprint"), next.name("fingerprint")};
  row.trusts_a_retired_authority = true;
  list.credentials.push_back(row);
  return list;
}

Problem every_problem() {
  Distinct next(1800);
  Problem problem = problem_without_goal(next);
  problem.goal_configurations = next.matrix(kJoints, 2);
  return problem;
}

Problem every_pose_problem() {
  Distinct next(1900);
  Problem problem = problem_without_goal(next);
  problem.T_task_goal = next.pose();
  problem.T_task_base.reset();
  problem.constraint.reset();
  return problem;
}

Problem every_problem_from_pose() {
  Problem problem = every_pose_problem();
  Distinct next(1950);
  problem.start.resize(0);
  problem.T_task_start = next.pose();
  return problem;
}

ProblemResult every_problem_result() {
  Distinct next(2000);
  ProblemResult result;
  result.name = next.name("problem");
  result.solved = true;
  result.collision_checks = next.count();
  result.goal_checks = next.count();
  result.shortcut_checks = next.count();
  result.projections = next.count();
  result.planning_time_s = next.real();
  result.time_limit_s = next.real();
  result.start = Eigen::VectorXd::LinSpaced(kJoints, 0.25, 0.5);
  result.not_planned = NotPlanned::StartOffConstraint;
  result.waypoints = next.matrix(kJoints, 3);
  result.distribution_id = next.id<Digest>();
  result.distribution_revision = next.count();
  result.sampling_mode = SamplingMode::Control;
  result.share = next.share() / 2;
  result.gate_fired = true;
  result.proven = true;
  result.least_clearance_m = 0.0625;
  result.refuted_edges = 3;
  result.track_share = 0.25;
  result.experience_revision = 12;
  result.tracks_followed = 3;
  result.guide = Guide::RetreatWays;
  result.found_by = FoundBy::Track;
  result.reason = next.text("reason");
  result.planner = next.text("planner");
  result.guidance_reason = next.text("reason");
  return result;
}

InverseAnswer every_inverse_answer() {
  Distinct next(2100);
  InverseAnswer answer;
  answer.solver = next.text("solver");
  answer.solutions = next.matrix(kJoints, 2);
  answer.reason = next.text("reason");
  answer.time_us = next.real();
  return answer;
}

RobotCheck every_robot_check() {
  Distinct next(2200);
  RobotCheck check;
  check.robot = next.id<Digest>();
  check.base_link = next.name("base");
  check.tip_link = next.name("tip");
  for (int i = 0; i < 2; ++i) {
    CheckedJoint joint;
    joint.name = next.name("joint");
    joint.type = next.text("type");
    joint.lower = -next.real();
    joint.upper = next.real();
    check.joints.push_back(joint);
  }
  check.structure = next.text("structure");
  check.solver = next.text("solver");
  check.poses = next.count();
  check.poses_without_solution = next.count();
  check.solutions_per_pose = next.real();
  check.time_per_pose_us = next.real();
  CheckedLink link;
  link.link = next.name("link");
  link.solids = next.count();
  link.size_x_m = next.real();
  link.size_y_m = next.real();
  link.size_z_m = next.real();
  link.from = next.text("from");
  check.links.push_back(link);
  return check;
}

}  // namespace kinship::test
