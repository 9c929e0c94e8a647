#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/unit/client/planner/plan_problem_answers.hpp"

namespace kinship::guided::plan_problem_test {
namespace {

TEST(PlanProblem, ThePathLeadsFromStartToGoalFreeAtTheResolution) {
  const Problem problem = wall_problem();
  const PlannedProblem answer = planned(problem);
  ASSERT_TRUE(answer.result.solved) << answer.result.reason;
  const Eigen::MatrixXd& path = *answer.result.waypoints;
  EXPECT_EQ(path.col(0), problem.start);
  EXPECT_EQ(path.col(path.cols() - 1), problem.goal_configurations.col(0));
  EXPECT_EQ(collisions_along(path, problem), 0);
  EXPECT_EQ(answer.outcome, Outcome::Solved);
  EXPECT_EQ(answer.result.reason, "");
}

TEST(PlanProblem, AGoalPoseIsReachedByTheTransferFrame) {
  Problem problem = wall_problem();
  const Eigen::Isometry3d T_task_base(Eigen::Translation3d(0.1, -0.2, 0));
  problem.T_task_base = T_task_base;
  problem.scene.objects[0].T_task_object = T_task_base * problem.scene.objects[0].T_task_object;
  const PlannedRobot robot = planar_robot();
  problem.T_task_goal =
      T_task_base * kinematics::T_base_transfer(robot.chain, problem.goal_configurations.col(0));
  problem.goal_configurations.resize(0, 0);
  const PlannedProblem answer = planned(problem);
  ASSERT_TRUE(answer.result.solved) << answer.result.reason;
  const Eigen::Isometry3d T_task_end =
      T_task_base * kinematics::T_base_transfer(robot.chain, answer.result.waypoints->rightCols(1));
  EXPECT_TRUE(T_task_end.isApprox(*problem.T_task_goal, 1e-5));
  EXPECT_GT(answer.result.goal_checks, 0U);
}

TEST(PlanProblem, EqualProblemAndSeedGiveEqualChecksAndPath) {
  const PlannedProblem first = planned(wall_problem());
  const PlannedProblem second = planned(wall_problem());
  EXPECT_EQ(first.result.collision_checks, second.result.collision_checks);
  EXPECT_EQ(first.result.shortcut_checks, second.result.shortcut_checks);
  EXPECT_EQ(*first.result.waypoints, *second.result.waypoints);
  Problem other = wall_problem();
  other.seed += 1;
  EXPECT_NE(planned(other).result.collision_checks, first.result.collision_checks);
}

TEST(PlanProblem, ShortcuttingKeepsItsBudgetAndShortensThePath) {
  PlanSettings without;
  without.shortcut_checks = 0;
  const PlannedProblem raw = planned(wall_problem(), without);
  const PlannedProblem shortened = planned(wall_problem());
  EXPECT_EQ(raw.result.shortcut_checks, 0U);
  EXPECT_LE(shortened.result.shortcut_checks, 300U);
  EXPECT_GT(shortened.result.shortcut_checks, 0U);
  EXPECT_EQ(raw.result.collision_checks, shortened.result.collision_checks);
  EXPECT_LT(planning::path_length(*shortened.result.waypoints),
            planning::path_length(*raw.result.waypoints));
}

TEST(PlanProblem, GuidanceIsNamedInTheResultAndChangesTheSamples) {
  const Guidance guidance = guidance_towards(Eigen::Vector4d(0, 2.2, 2.2, 0.5));
  const PlannedProblem answer = planned(wall_problem(), {}, {&guidance, SamplingMode::Guided});
  EXPECT_EQ(answer.result.distribution_id, guidance.distribution_id);
  EXPECT_EQ(answer.result.distribution_revision, 5U);
  EXPECT_EQ(answer.result.sampling_mode, SamplingMode::Guided);
  EXPECT_EQ(answer.result.share, 0.9);
  EXPECT_EQ(answer.result.guidance_reason, "");
  EXPECT_NE(answer.result.collision_checks, planned(wall_problem()).result.collision_checks);
}

TEST(PlanProblem, GuidanceOfAnotherPlacementIsRefusedAndBothAreNamed) {
  Guidance guidance = guidance_towards(Eigen::Vector4d(0, 2.2, 2.2, 0.5));
  guidance.T_task_base = Eigen::Isometry3d::Identity();
  Problem problem = wall_problem();
  EXPECT_TRUE(planned(problem, {}, {&guidance, SamplingMode::Guided}).attempted);
  guidance.T_task_base->translation().x() = 0.001;  // as far as requests are snapped
  EXPECT_TRUE(planned(problem, {}, {&guidance, SamplingMode::Guided}).attempted);
  guidance.T_task_base->translation().x() = 0.5;
  const PlannedProblem answer = planned(problem, {}, {&guidance, SamplingMode::Guided});
  EXPECT_FALSE(answer.attempted);
  EXPECT_FALSE(answer.result.solved);
  EXPECT_NE(answer.result.reason.find("the guidance was made for 0.5 0 0 0 0 0 1"),
            std::string::npos)
      << answer.result.reason;
  EXPECT_EQ(answer.result.reason.find("T_task_base is "), 0U) << answer.result.reason;
}

TEST(PlanProblem, AQueryThatIsNotGuidedIsPlannedAsWithoutGuidance) {
  const Guidance guidance = guidance_towards(Eigen::Vector4d(0, 2.2, 2.2, 0.5));
  const ProblemResult uniform = planned(wall_problem()).result;
  for (const SamplingMode mode : {SamplingMode::Control, SamplingMode::Uniform}) {
    const ProblemResult result = planned(wall_problem(), {}, {&guidance, mode}).result;
    EXPECT_EQ(result.sampling_mode, mode);
    EXPECT_EQ(result.share, 0);
    EXPECT_FALSE(result.gate_fired);
    EXPECT_EQ(result.guidance_reason, mode == SamplingMode::Control ? "planned uniformly as control"
                                                                    : "planned uniformly by wish");
    EXPECT_EQ(result.distribution_id, guidance.distribution_id);
    EXPECT_EQ(result.collision_checks, uniform.collision_checks);
    EXPECT_EQ(*result.waypoints, *uniform.waypoints);
  }
}

TEST(PlanProblem, TheFartherAQueryIsFromTheMixtureTheLessItIsGuidedByIt) {
  const auto guided = [](double distance, double gate_distance) {
    const Guidance away = guidance_towards(Eigen::Vector4d::Constant(distance));
    PlanSettings settings;
    settings.gate_distance = gate_distance;
    return planned(wall_problem(), settings, {&away, SamplingMode::Guided}).result;
  };
  EXPECT_FALSE(guided(0.5, 60).gate_fired);
  EXPECT_EQ(guided(0.5, 60).share, 0.9);
  const ProblemResult part = guided(2.5, 60);
  EXPECT_TRUE(part.gate_fired);
  EXPECT_GT(part.share, 0.01);
  EXPECT_LT(part.share, 0.9);
  EXPECT_EQ(part.sampling_mode, SamplingMode::Guided);
  EXPECT_EQ(part.guidance_reason, "start or goals are far from all that the distribution knows");

  const ProblemResult none = guided(2.5, 1);
  EXPECT_TRUE(none.gate_fired);
  EXPECT_EQ(none.share, 0);
  EXPECT_TRUE(none.distribution_id);
  const ProblemResult uniform = planned(wall_problem()).result;
  EXPECT_EQ(none.collision_checks, uniform.collision_checks);
  EXPECT_EQ(*none.waypoints, *uniform.waypoints);
}

TEST(PlanProblem, TheGateCanBeLeftOpen) {
  const Guidance far = guidance_towards(Eigen::Vector4d(2.5, 2.5, 2.5, 2.5));
  PlanSettings open;
  open.gate_distance = std::numeric_limits<double>::infinity();
  const ProblemResult guided = planned(wall_problem(), open, {&far, SamplingMode::Guided}).result;
  EXPECT_FALSE(guided.gate_fired);
  EXPECT_EQ(guided.share, 0.9);
}

TEST(PlanProblem, RunningOutOfChecksIsATimeoutWithItsReason) {
  PlanSettings few;
  few.max_checks = 20;
  const PlannedProblem answer = planned(wall_problem(), few);
  EXPECT_FALSE(answer.result.solved);
  EXPECT_FALSE(answer.result.waypoints);
  EXPECT_EQ(answer.outcome, Outcome::Timeout);
  EXPECT_EQ(answer.result.collision_checks, 20U);
  EXPECT_EQ(answer.result.reason, "not solved within 20 collision checks");
  EXPECT_TRUE(answer.attempted);
}

TEST(PlanProblem, RunningOutOfTimeIsATimeoutWithItsReason) {
  Problem problem = wall_problem();
  problem.time_limit_s = 0;
  const PlannedProblem answer = planned(problem);
  EXPECT_EQ(answer.outcome, Outcome::Timeout);
  EXPECT_EQ(answer.result.reason, "not solved within 0.000000 s");
}

TEST(PlanProblem, ACollidingStartNamesWhatTouches) {
  Problem problem = wall_problem();
  problem.start.setZero();
  const PlannedProblem answer = planned(problem);
  EXPECT_EQ(answer.outcome, Outcome::Failed);
  EXPECT_EQ(answer.result.reason, "start collides: 'l4' touches 'wall'");
}

TEST(PlanProblem, CollidingGoalsNameWhatTouches) {
  Problem problem = wall_problem();
  problem.scene.objects.push_back(
      {"lump", SphereShape{0.25}, Eigen::Isometry3d(Eigen::Translation3d(0.45, -0.95, 0))});
  EXPECT_EQ(planned(problem).result.reason, "every goal collides: 'l3' or 'l4' touches 'lump'");
  problem.T_task_goal =
      kinematics::T_base_transfer(planar_robot().chain, problem.goal_configurations.col(0));
  problem.goal_configurations.resize(0, 0);
  const PlannedProblem posed = planned(problem);
  EXPECT_EQ(posed.result.reason.find("every goal collides: 'l"), 0U) << posed.result.reason;
  EXPECT_NE(posed.result.reason.find(" touches 'lump' in "), std::string::npos)
      << posed.result.reason;
  EXPECT_EQ(posed.outcome, Outcome::Failed);
  EXPECT_TRUE(posed.attempted);
}

/// What hides most of the goals comes first, with both bodies.
TEST(PlanProblem, CollidingGoalsSayWhichObjectHidesHowManyOfThem) {
  Problem problem = wall_problem();
  problem.scene.objects.clear();
  problem.scene.objects.push_back(
      {"box", BoxShape{{0.1, 0.1, 0.1}}, Eigen::Isometry3d(Eigen::Translation3d(0, -1.15, 0))});
  problem.scene.objects.push_back(
      {"shelf", BoxShape{{0.1, 0.1, 0.1}}, Eigen::Isometry3d(Eigen::Translation3d(0, 1.15, 0))});
  problem.goal_configurations.resize(4, 3);
  problem.goal_configurations << 1.57, 1.6, -1.57, 0, 0, 0, 0, 0, 0, 0, 0, 0;
  const PlannedProblem answer = planned(problem);
  EXPECT_EQ(answer.result.not_planned, NotPlanned::GoalCollides);
  EXPECT_EQ(
      answer.result.reason,
      "every goal collides: 'l4' touches 'shelf' in 2 of 3 configurations, 'l4' touches 'box' "
      "in 1 of 3");
}

TEST(PlanProblem, AGoalOutOfReachIsSaid) {
  Problem problem = wall_problem();
  problem.goal_configurations.resize(0, 0);
  problem.T_task_goal = Eigen::Isometry3d(Eigen::Translation3d(9, 0, 0));
  const PlannedProblem answer = planned(problem);
  EXPECT_FALSE(answer.result.solved);
  EXPECT_EQ(answer.outcome, Outcome::Failed);
  EXPECT_EQ(answer.result.reason, "goal out of reach: its place is out of reach by 7.8 m");
}

TEST(PlanProblem, AGoalReachedOnlyBeyondTheLimitsNamesTheJoint) {
  Problem problem = wall_problem();
  problem.goal_configurations.resize(0, 0);
  problem.T_task_goal =
      kinematics::T_base_transfer(planar_robot().chain, Eigen::Vector4d(3.1, 0, 0, 0));
  const std::string reason = planned(problem).result.reason;
  EXPECT_EQ(
      reason.find("goal only reached outside the joint limits: joint 'j1' would have to go to "
                  "3."),
      0U)
      << reason;
}

/// A goal of a planar arm whose axes nobody has named, off by rounding.
TEST(PlanProblem, AGoalWhoseOrientationAloneIsOutOfReachNamesTheAxesThatSolveIt) {
  RobotDescription description = test::planar_description();
  description.task_axes = {};
  kinematics::Chain chain = kinematics::read_chain(description).value_or_throw();
  const PlannedRobot robot{
      chain,
      geometry::read_shapes(kinematics::read_model(description).value_or_throw()).value_or_throw()};
  Problem problem = wall_problem();
  Eigen::Isometry3d T_goal = kinematics::T_base_transfer(chain, problem.goal_configurations.col(0));
  T_goal.rotate(Eigen::AngleAxisd(1e-4, Eigen::Vector3d::UnitX()));
  problem.T_task_goal = T_goal;
  problem.goal_configurations.resize(0, 0);
  const PlannedProblem answer = plan_problem(robot, problem, {}, {}, never);
  EXPECT_EQ(answer.result.not_planned, NotPlanned::GoalOutOfReach);
  EXPECT_NE(answer.result.reason.find(": its place is in reach, its orientation is not, by 0.0001 "
                                      "rad; with --axes x,y,z,"),
            std::string::npos)
      << answer.result.reason;
}

/// The wall's problem, its start a pose of the transfer frame, where the robot stands elsewhere.
Problem posed_problem() {
  Problem problem = wall_problem();
  const Eigen::Isometry3d T_task_base(Eigen::Translation3d(0.1, -0.2, 0));
  problem.T_task_base = T_task_base;
  problem.scene.objects[0].T_task_object = T_task_base * problem.scene.objects[0].T_task_object;
  problem.T_task_start =
      T_task_base * kinematics::T_base_transfer(planar_robot().chain, problem.start);
  problem.start.resize(0);
  return problem;
}

TEST(PlanProblem, AStartPoseIsPlannedFromAFreeConfigurationThatTheResultNames) {
  const Problem problem = posed_problem();
  const PlannedProblem answer = planned(problem);
  ASSERT_TRUE(answer.result.solved) << answer.result.reason;
  ASSERT_TRUE(answer.result.start);
  EXPECT_EQ(answer.result.waypoints->col(0), *answer.result.start);
  const Eigen::Isometry3d T_task_begin =
      *problem.T_task_base *
      kinematics::T_base_transfer(planar_robot().chain, *answer.result.start);
  EXPECT_TRUE(T_task_begin.isApprox(*problem.T_task_start, 1e-5));
  EXPECT_EQ(collisions_along(*answer.result.waypoints, problem), 0);
  EXPECT_GT(answer.result.goal_checks, 0U);
}

TEST(PlanProblem, AStartPoseHasTheSameConfigurationUnderEverySeed) {
  Problem problem = posed_problem();
  const Eigen::VectorXd first = *planned(problem).result.start;
  problem.seed += 1;
  EXPECT_EQ(*planned(problem).result.start, first);
}

TEST(PlanProblem, StartAndGoalMayBothBePoses) {
  Problem problem = posed_problem();
  problem.T_task_goal =
      *problem.T_task_base *
      kinematics::T_base_transfer(planar_robot().chain, problem.goal_configurations.col(0));
  problem.goal_configurations.resize(0, 0);
  const PlannedProblem answer = planned(problem);
  ASSERT_TRUE(answer.result.solved) << answer.result.reason;
  EXPECT_EQ(answer.result.not_planned, std::nullopt);
}

TEST(PlanProblem, AStartPoseThatCannotBeSaysWhy) {
  Problem problem = posed_problem();
  problem.T_task_start = Eigen::Isometry3d(Eigen::Translation3d(9, 0, 0));
  PlannedProblem answer = planned(problem);
  EXPECT_EQ(answer.result.reason.find("start out of reach: its place is out of reach by "), 0U)
      << answer.result.reason;
  EXPECT_EQ(answer.result.not_planned, NotPlanned::StartOutOfReach);
  EXPECT_EQ(answer.result.start, std::nullopt);

  problem.T_task_start =
      *problem.T_task_base *
      kinematics::T_base_transfer(planar_robot().chain, Eigen::Vector4d(3.1, 0, 0, 0));
  answer = planned(problem);
  EXPECT_EQ(answer.result.reason.find("start only reached outside the joint limits: joint 'j1' "),
            0U)
      << answer.result.reason;
  EXPECT_EQ(answer.result.not_planned, NotPlanned::StartBeyondLimits);

  // The wall's middle, which the last link is in whatever the others do.
  problem.T_task_start = *problem.T_task_base * Eigen::Translation3d(0.8, 0, 0) *
                         Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());
  answer = planned(problem);
  EXPECT_EQ(answer.result.not_planned, NotPlanned::StartCollides);
  EXPECT_EQ(answer.result.reason.find("every configuration of the start collides: 'l4' "), 0U)
      << answer.result.reason;
  EXPECT_NE(answer.result.reason.find(" touches 'wall' in "), std::string::npos)
      << answer.result.reason;
  EXPECT_EQ(answer.outcome, Outcome::Failed);
}

// With a start pose as with a start configuration.
TEST(PlanProblem, WhatBreaksWhileGoalsAreFoundIsNoSearch) {
  Problem problem = posed_problem();
  problem.goal_configurations.resize(0, 0);
  problem.T_task_goal = *problem.T_task_base * Eigen::Translation3d(0.8, 0, 0) *
                        Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());  // in the wall
  int asked = 0, last = 0;
  const auto plan = [&] {
    return plan_problem(planar_robot(), problem, {}, {}, [&] {
      if (++asked == last)
        throw std::runtime_error("broken");
      return false;
    });
  };
  EXPECT_EQ(plan().result.not_planned, NotPlanned::GoalCollides);
  last = std::exchange(asked, 0);
  const PlannedProblem answer = plan();
  EXPECT_EQ(answer.result.reason, "broken");
  EXPECT_EQ(answer.result.not_planned, NotPlanned::Error);
}

TEST(PlanProblem, TellsASearchInVainFromNone) {
  const PlannedProblem found = planned(wall_problem());
  EXPECT_EQ(found.result.not_planned, std::nullopt);
  EXPECT_EQ(*found.result.start, wall_problem().start);
  PlanSettings poor;
  poor.max_checks = 20;
  EXPECT_EQ(planned(wall_problem(), poor).result.not_planned, std::nullopt);

  Problem problem = wall_problem();
  problem.start.setZero();
  EXPECT_EQ(planned(problem).result.not_planned, NotPlanned::StartCollides);
  problem = wall_problem();
  problem.goal_configurations.setZero();
  EXPECT_EQ(planned(problem).result.not_planned, NotPlanned::GoalCollides);
  problem.goal_configurations.resize(0, 0);
  problem.T_task_goal = Eigen::Isometry3d(Eigen::Translation3d(9, 0, 0));
  EXPECT_EQ(planned(problem).result.not_planned, NotPlanned::GoalOutOfReach);
  problem.start = Eigen::VectorXd::Zero(6);
  EXPECT_EQ(planned(problem).result.not_planned, NotPlanned::DofMismatch);
  problem = wall_problem();
  problem.start[2] = 3;
  EXPECT_EQ(planned(problem).result.not_planned, NotPlanned::StartBeyondLimits);
  problem = wall_problem();
  problem.attached.push_back({"box", "hand", BoxShape{{0.1, 0.1, 0.1}}, {}, {}});
  EXPECT_EQ(planned(problem).result.not_planned, NotPlanned::Error);
}

TEST(PlanProblem, AProblemOfAnotherRobotIsAnsweredNotAttempted) {
  Problem problem = wall_problem();
  problem.start = Eigen::VectorXd::Zero(6);
  const PlannedProblem answer = planned(problem);
  EXPECT_FALSE(answer.attempted);
  EXPECT_EQ(answer.result.reason, "start has 6 joints, the robot 4: 'j1', 'j2', 'j3', 'j4'");
  problem = wall_problem();
  problem.start[2] = 3;
  EXPECT_EQ(planned(problem).result.reason,
            "start: joint 'j3' at 3.000000 is outside -2.800000 to 2.800000");
  EXPECT_FALSE(planned(problem).attempted);
  problem = wall_problem();
  problem.attached.push_back({"box", "hand", BoxShape{{0.1, 0.1, 0.1}}, {}, {}});
  EXPECT_NE(planned(problem).result.reason.find("hand"), std::string::npos);
}

TEST(PlanProblem, GoalsOfAnotherRobotAreAnsweredNotAttempted) {
  Problem problem = wall_problem();
  problem.goal_configurations = Eigen::VectorXd::Zero(6);
  EXPECT_EQ(planned(problem).result.reason,
            "goal configurations have 6 joints, the robot 4: 'j1', 'j2', 'j3', 'j4'");
}

TEST(PlanProblem, AGoalBeyondALimitNamesGoalJointValueAndLimit) {
  Problem problem = wall_problem();
  problem.goal_configurations.conservativeResize(4, 2);
  problem.goal_configurations.col(1) << -0.9, 3.5, 0, 0;
  const PlannedProblem answer = planned(problem);
  EXPECT_FALSE(answer.attempted);
  EXPECT_FALSE(answer.result.solved);
  EXPECT_EQ(answer.result.reason,
            "goal 2: joint 'j2' at 3.500000 is outside -2.800000 to 2.800000");
}

TEST(PlanProblem, StartsAndGoalsBeyondALimitByLessThanTheSlackAreMovedOntoItAndSaid) {
  Problem problem = wall_problem();
  problem.scene.objects.clear();
  problem.start[2] = -2.80009;
  problem.goal_configurations.col(0) << 2.80009, 0, 0, 0;
  PlanSettings settings;
  const PlannedProblem answer =
      plan_problem(planar_robot("-2.8", "2.8"), problem, {}, settings, never);
  ASSERT_TRUE(answer.result.solved) << answer.result.reason;
  EXPECT_EQ(answer.result.waypoints->leftCols(1)(2), -2.8);
  EXPECT_EQ(answer.result.waypoints->rightCols(1)(0), 2.8);
  EXPECT_EQ(answer.moved, (std::vector<std::string>{
                              "start: joint 'j3' at -2.80009 is moved onto its limit -2.8",
                              "goal 1: joint 'j1' at 2.80009 is moved onto its limit 2.8"}));
  settings.limit_slack = 0;
  const PlannedProblem refused =
      plan_problem(planar_robot("-2.8", "2.8"), problem, {}, settings, never);
  EXPECT_EQ(refused.result.not_planned, NotPlanned::StartBeyondLimits);
  EXPECT_TRUE(refused.moved.empty());
  problem.goal_configurations(0, 0) = 2.80011;
  EXPECT_EQ(planned(problem).result.reason,
            "goal 1: joint 'j1' at 2.800110 is outside -2.800000 to 2.800000");
}

TEST(PlanProblem, AGoalBeyondALimitByRoundingEndsAtTheLimit) {
  Problem problem = wall_problem();
  problem.scene.objects.clear();
  problem.goal_configurations.col(0) << 2.8 + 1e-7, 0, 0, 0;
  const PlannedProblem answer = planned(problem);
  ASSERT_TRUE(answer.result.solved) << answer.result.reason;
  EXPECT_EQ(answer.result.waypoints->rightCols(1)(0), 2.8);
}

TEST(PlanProblem, AGoalIsTurnedIntoTheTurnOfTheStart) {
  const PlannedRobot robot = planar_robot("-6.2", "6.2");
  Problem problem = wall_problem();
  problem.scene.objects.clear();
  problem.start[0] = 3;
  problem.goal_configurations(0, 0) = -3;
  const PlannedProblem answer = plan_problem(robot, problem, {}, {}, never);
  ASSERT_TRUE(answer.result.solved) << answer.result.reason;
  EXPECT_NEAR(answer.result.waypoints->rightCols(1)(0), 2 * M_PI - 3, 1e-9);
}

TEST(PlanProblem, StopsWhenAsked) {
  int asked = 0;
  const PlannedProblem answer =
      plan_problem(planar_robot(), wall_problem(), {}, {}, [&] { return ++asked > 10; });
  EXPECT_TRUE(answer.interrupted);
  EXPECT_EQ(asked, 11);
}

}  // namespace
}  // namespace kinship::guided::plan_problem_test
