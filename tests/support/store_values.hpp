#pragma once

#include <cstdint>
#include <future>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "server/store/store.hpp"

/// Robots, attempts and distributions to put into a store, equal for equal numbers.
namespace kinship::test {

inline constexpr std::uint32_t kDof = 3;

/// A digest or UUID made from a number.
template <typename Id>
Id id_from(std::uint64_t number) {
  std::mt19937_64 generator(number);
  Id id;
  for (std::uint8_t& byte : id.bytes)
    byte = static_cast<std::uint8_t>(generator());
  return id;
}

inline std::vector<Uuid> uuids_from(const std::vector<std::uint64_t>& numbers) {
  std::vector<Uuid> uuids;
  for (const std::uint64_t number : numbers)
    uuids.push_back(id_from<Uuid>(number));
  return uuids;
}

inline store::RobotRecord make_robot(const std::string& label, std::uint64_t number) {
  store::RobotRecord robot;
  robot.digest = id_from<Digest>(number);
  robot.dof = kDof;
  robot.registered_ms = 1'700'000'000'000 + static_cast<std::int64_t>(number);
  robot.description.label = label;
  robot.description.urdf = "<robot name='" + label + "'/>";
  robot.description.base_link = "base";
  robot.description.tip_link = "tip";
  robot.description.T_tip_transfer.translation() << 0.1, -0.2, 0.3;
  robot.description.task_axes.matters = {true, true, false, false, false, true};
  robot.description.held_joints = {{"finger_1", 0.02}, {"finger_2", 0.02}};
  robot.description.never_colliding = {{"link_3", "link_1"}, {"link_2", "palm"}};
  return robot;
}

inline Path make_path(std::uint64_t number, Eigen::Index dof = kDof, Eigen::Index size = 20) {
  std::mt19937_64 generator(number);
  std::uniform_real_distribution<double> joint(-3, 3);
  return Path(Eigen::MatrixXd::NullaryExpr(dof, size, [&] { return joint(generator); }));
}

inline Eigen::Isometry3d make_pose() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translate(Eigen::Vector3d(1, 2, 3));
  T.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()));
  return T;
}

/// Solved; its UUID and path come from `number`.
inline Attempt make_attempt(const Digest& robot, const std::string& task, std::uint64_t number) {
  Attempt attempt;
  attempt.report_uuid = id_from<Uuid>(number);
  attempt.robot = robot;
  attempt.machine = "cell 7";
  attempt.task = task;
  attempt.T_task_base = make_pose();
  attempt.record.outcome = Outcome::Solved;
  attempt.record.planner = "birrt";
  attempt.record.planner_options = "step=0.1";
  attempt.record.planning_time_s = 0.25;
  attempt.record.collision_checks = 1234;
  attempt.record.projections = 5;
  attempt.record.time_limit_s = 10;
  attempt.record.sampling_mode = SamplingMode::Control;
  attempt.record.share = 0.5;
  attempt.record.distribution_id = id_from<Digest>(99);
  attempt.record.distribution_revision = 7;
  attempt.path = make_path(number);
  return attempt;
}

inline Attempt make_unsolved(const Digest& robot, const std::string& task, std::uint64_t number) {
  Attempt attempt = make_attempt(robot, task, number);
  attempt.record.outcome = Outcome::Timeout;
  attempt.path.reset();
  return attempt;
}

/// Whether a store gives back what was reported; another attempt of equal content may have the
/// path.
inline bool is_as_reported(const Attempt& found, const Attempt& wanted) {
  return found.robot == wanted.robot && found.task == wanted.task &&
         found.record.outcome == wanted.record.outcome &&
         found.record.collision_checks == wanted.record.collision_checks &&
         (!found.path || (wanted.path && found.path->waypoints() == wanted.path->waypoints()));
}

/// Ready, with two components.
inline Distribution make_distribution(const Digest& robot, const std::string& task,
                                      std::uint64_t number) {
  Distribution distribution;
  distribution.id = id_from<Digest>(number);
  distribution.task = task;
  distribution.robot = robot;
  distribution.T_task_base = make_pose();
  distribution.profile = "default";
  distribution.engines = "transfer 1, density 1";
  distribution.reason = "2 of 5 poses out of reach";
  Source& source = distribution.sources.emplace_back();
  source.robot = robot;
  source.label = "panda";
  source.paths = 12;
  source.generation = 3;
  source.poses = 640;
  source.poses_solved = 600;
  distribution.configurations = 3000;
  const std::vector<Eigen::MatrixXd> covariances(2, 0.25 * Eigen::MatrixXd::Identity(kDof, kDof));
  distribution.mixture =
      Mixture(Eigen::Vector2d(0.25, 0.75), make_path(number, kDof, 2).waypoints(), covariances);
  distribution.limits = Eigen::Matrix2Xd::Zero(2, kDof);
  distribution.limits.row(1).setConstant(2.5);
  distribution.held_out_score = -1.5;
  distribution.component_scores = {{20, -2.5}, {2, -1.5}};
  distribution.cuts.resize(kDof);
  distribution.cuts[1] = 0.5;
  distribution.fit = FitOrigin{4, 2, 525, 25, 26, "of a test"};
  distribution.advice.recommended_share = 0.9;
  distribution.advice.evidence = "none yet";
  distribution.fitted_ms = 1'700'000'000'123;
  distribution.transfer_time_s = 0.5;
  distribution.fit_time_s = 0.125;
  return distribution;
}

/// With a library of two queries; its waypoints are floats.
inline store::StoredRehearsal make_rehearsal(const Digest& robot, const std::string& task,
                                             std::uint64_t number) {
  store::StoredRehearsal rehearsal{.id = id_from<Digest>(number),
                                   .robot = robot,
                                   .task = task,
                                   .made_ms = 1'700'000'000'321,
                                   .kind = id_from<Digest>(number + 1),
                                   .paths = 50 + number,
                                   .retired = 7,
                                   .T_task_base = make_pose()};
  rehearsal.rehearsal = {.guide = Guide::RecallRetreat,
                         .is_complete = true,
                         .queries = 40,
                         .left_out = 2,
                         .processor_time_s = 1.5,
                         .costs = {{Guide::Ways, 160, 150, 1250.5, 400, 0.004}},
                         .message = "with the shapes that the server knows"};
  RecallLibrary& library = rehearsal.library.emplace();
  library.revision = 1000 + number;
  library.search_checks = 800.5;
  library.try_checks = 12.25;
  library.anchors = {"shelf"};
  for (const bool is_synthetic : {false, true})
    library.queries.push_back({id_from<Uuid>(number),
                               is_synthetic,
                               make_pose(),
                               make_path(number).waypoints().col(0),
                               make_path(number).waypoints().col(1),
                               {make_pose()}});
  library.paths = {
      {1, make_path(number, kDof, kRecallWaypoints).waypoints().cast<float>().cast<double>()}};
  library.modes = {{2, kGoalFrame}, {1, kFirstAnchor}};
  library.solves = {0b0110};
  library.reaches = {0b1110};
  return rehearsal;
}

/// Reports and waits for the receipts.
inline std::vector<Receipt> report(store::Store& store, std::vector<Attempt> attempts) {
  std::promise<std::vector<Receipt>> done;
  store.commit_reports(std::move(attempts),
                       [&](const std::vector<Receipt>& receipts) { done.set_value(receipts); });
  return done.get_future().get();
}

/// An attempt of a task, which is there with it: for a distribution of the task.
inline void begin_task(store::Store& store, const Digest& robot, const std::string& task) {
  report(store, {make_unsolved(robot, task, 987'654)});
}

inline std::vector<ReceiptStatus> statuses(const std::vector<Receipt>& receipts) {
  std::vector<ReceiptStatus> found;
  for (const Receipt& receipt : receipts)
    found.push_back(receipt.status);
  return found;
}

}  // namespace kinship::test
