#include "client/guided/attempt_record.hpp"

#include <gtest/gtest.h>

#include "proto/evidence/machine_speed.hpp"
#include "robots/planning/path_vertices.hpp"
#include "tests/unit/client/planner/planar_problem.hpp"

namespace kinship::guided::attempt_record_test {
namespace {

const PlannedRobot kRobot = test::planar_robot();
const Reporter kReporter = {kRobot, "cell 3", "box_to_shelf"};

PlannedProblem solved() {
  PlannedProblem planned;
  planned.outcome = Outcome::Solved;
  planned.result.solved = true;
  planned.result.collision_checks = 1234;
  planned.result.shortcut_checks = 300;
  planned.result.planning_time_s = 0.5;
  planned.result.processor_time_s = 0.75;
  planned.planner = "CBiRRT2";
  planned.result.time_limit_s = 10;
  planned.result.waypoints = Eigen::MatrixXd::Random(3, 4);
  planned.result.path_length = 4;
  planned.result.hand_length_m = 1.5;
  planned.result.least_clearance_m = 0.03;
  return planned;
}

TEST(AttemptRecord, ASolvedProblemBringsItsPathAndPlanningChecks) {
  Problem problem;
  problem.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(0.25, 0, 0));
  const PlannedProblem planned = solved();
  const Attempt attempt = make_attempt(kReporter, problem, planned, {});
  ASSERT_TRUE(attempt.path);
  EXPECT_EQ(attempt.path->waypoints(), *planned.result.waypoints);
  EXPECT_EQ(attempt.record.outcome, Outcome::Solved);
  EXPECT_EQ(attempt.record.collision_checks, 1234U);  // without those of shortcutting
  EXPECT_EQ(attempt.record.processor_time_s, 0.75);
  EXPECT_EQ(attempt.record.machine_speed, evidence::machine_speed());
  EXPECT_EQ(attempt.record.hand_length_m, 1.5);
  EXPECT_EQ(attempt.record.least_clearance_m, 0.03);
  EXPECT_EQ(attempt.record.planner, "CBiRRT2");
  EXPECT_EQ(attempt.record.sampling_mode, SamplingMode::Uniform);
  EXPECT_EQ(attempt.task, "box_to_shelf");
  EXPECT_EQ(attempt.machine, "cell 3");
  EXPECT_EQ(attempt.T_task_base->translation().x(), 0.25);
}

TEST(AttemptRecord, APathThatNobodyMeasuredIsMeasured) {
  PlannedProblem planned = solved();
  planned.result.path_length.reset();
  planned.result.waypoints = Eigen::MatrixXd::Zero(kRobot.chain.dof(), 2);
  planned.result.waypoints->col(1).setConstant(0.2);
  const PlanningRecord record = make_attempt(kReporter, {}, planned, {}).record;
  EXPECT_EQ(record.hand_length_m, planning::hand_length_m(kRobot.chain, *planned.result.waypoints));
  EXPECT_NE(record.least_clearance_m, 0.03);
}

TEST(AttemptRecord, AMissingPlacementIsReportedAsMissing) {
  EXPECT_FALSE(make_attempt(kReporter, {}, solved(), {}).T_task_base);
}

TEST(AttemptRecord, AnUnsolvedProblemHasNoPath) {
  PlannedProblem planned = solved();
  planned.outcome = Outcome::Timeout;
  planned.result.waypoints.reset();
  const Attempt attempt = make_attempt(kReporter, {}, planned, {});
  EXPECT_FALSE(attempt.path);
  EXPECT_EQ(attempt.record.outcome, Outcome::Timeout);
}

TEST(AttemptRecord, AGuidedAttemptNamesItsDistribution) {
  PlannedProblem planned = solved();
  planned.result.distribution_id = Digest{};
  planned.result.distribution_revision = 4;
  planned.result.sampling_mode = SamplingMode::Guided;
  planned.result.share = 0.9;
  const Attempt attempt = make_attempt(kReporter, {}, planned, {});
  EXPECT_EQ(attempt.record.sampling_mode, SamplingMode::Guided);
  EXPECT_EQ(attempt.record.distribution_id, Digest{});
  EXPECT_EQ(attempt.record.distribution_revision, 4U);
  EXPECT_EQ(attempt.record.share, 0.9);
}

TEST(AttemptRecord, AControlAttemptIsTold) {
  PlannedProblem planned = solved();
  planned.result.distribution_id = Digest{};
  planned.result.sampling_mode = SamplingMode::Control;
  const Attempt attempt = make_attempt(kReporter, {}, planned, {});
  EXPECT_EQ(attempt.record.sampling_mode, SamplingMode::Control);
  EXPECT_EQ(attempt.record.share, 0);
}

TEST(AttemptRecord, AGuidedAttemptStaysGuidedWhereTheGateFired) {
  PlannedProblem planned = solved();
  planned.result.distribution_id = Digest{};
  planned.result.sampling_mode = SamplingMode::Guided;
  planned.result.gate_fired = true;
  const PlanningRecord record = make_attempt(kReporter, {}, planned, {}).record;
  EXPECT_EQ(record.sampling_mode, SamplingMode::Guided);
  EXPECT_EQ(record.share, 0);
  EXPECT_TRUE(record.planner_options.ends_with(" gate=fired")) << record.planner_options;
}

TEST(AttemptRecord, SaysHowWasPlannedAndUnderWhichUuid) {
  PlanSettings settings;
  settings.resolution = 0.1;
  const Attempt first = make_attempt(kReporter, {}, solved(), settings);
  const Attempt second = make_attempt(kReporter, {}, solved(), settings);
  EXPECT_EQ(first.record.planner_options,
            "step=0.1 clearance_m=0.001 overshoot=1.5 shortcut_checks=300 max_checks=100000");
  EXPECT_NE(first.report_uuid, second.report_uuid);
}

}  // namespace
}  // namespace kinship::guided::attempt_record_test
