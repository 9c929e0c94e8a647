#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "client/ompl/planner_choice.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/unit/client/planner/plan_problem_answers.hpp"

/// Each planner, and what it makes of a constraint.
namespace kinship::guided::plan_problem_test {
namespace {

/// The wall's problem without the wall, the transfer frame on the line x = const of its start.
Problem line_problem() {
  Problem problem = wall_problem();
  problem.scene.objects.clear();
  problem.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(0.3, -0.2, 0));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  TaskSpaceRegion line;
  line.T_task_region.translation() =
      (*problem.T_task_base * kinematics::T_base_transfer(planar_robot().chain, problem.start))
          .translation();
  line.bounds.row(0) << 0, -kInfinity, 0, 0, 0, -kInfinity;
  line.bounds.row(1) = -line.bounds.row(0);
  problem.constraint = line;
  return problem;
}

TEST(PlanProblem, UnderAConstraintEveryWaypointKeepsToIt) {
  const Problem problem = line_problem();
  PlanSettings direct;
  direct.shortcut_checks = 0;
  for (const PlanSettings& settings : {direct, PlanSettings()}) {
    const PlannedProblem answer = planned(problem, settings);
    ASSERT_TRUE(answer.result.solved) << answer.result.reason;
    EXPECT_GT(answer.result.projections, 0u);
    const Eigen::MatrixXd& path = *answer.result.waypoints;
    EXPECT_EQ(path.col(0), problem.start);
    EXPECT_EQ(path.rightCols<1>(), problem.goal_configurations);
    const double x = problem.constraint->T_task_region.translation().x();
    for (Eigen::Index i = 0; i < path.cols(); ++i) {
      const Eigen::Isometry3d T_task_transfer =
          *problem.T_task_base * kinematics::T_base_transfer(planar_robot().chain, path.col(i));
      EXPECT_NEAR(T_task_transfer.translation().x(), x, 1e-3);
      if (i > 0) {
        EXPECT_LE((path.col(i) - path.col(i - 1)).norm(), settings.resolution + 1e-8);
      }
    }
  }
}

TEST(PlanProblem, APlannerThatCannotKeepToAConstraintIsNotStarted) {
  PlanSettings settings;
  settings.planner.kind = PlannerKind::Birrt;
  const PlannedProblem refused = planned(line_problem(), settings);
  EXPECT_FALSE(refused.attempted);
  EXPECT_EQ(refused.result.planner, "");
  EXPECT_EQ(refused.result.reason,
            "--planner birrt does not keep to a constraint: use --planner cbirrt2 or roadmap");
  EXPECT_EQ(planned(wall_problem(), settings).result.planner, "BiRRT");
  EXPECT_EQ(planned(line_problem()).result.planner, "CBiRRT2");
}

TEST(PlanProblem, APlannerOfOmplAnswersWithAndWithoutAConstraint) {
  PlanSettings settings;
  settings.planner = ompl_planners::parse_planner("ompl:RRTConnect").value();
  const ProblemResult free = planned(wall_problem(), settings).result;
  ASSERT_TRUE(free.solved) << free.reason;
  EXPECT_EQ(free.planner, "OMPL RRTConnect");
  EXPECT_EQ(collisions_along(*free.waypoints, wall_problem()), 0);
  const Problem problem = line_problem();
  const ProblemResult along = planned(problem, settings).result;
  ASSERT_TRUE(along.solved) << along.reason;
  for (const auto& q : along.waypoints->colwise()) {
    const Eigen::Isometry3d T_task_transfer =
        *problem.T_task_base * kinematics::T_base_transfer(planar_robot().chain, q);
    EXPECT_NEAR(T_task_transfer.translation().x(),
                problem.constraint->T_task_region.translation().x(), 1e-3);
  }
}

TEST(PlanProblem, RrtConnectAnswersWithProvenLinesAndWithChecksAlone) {
  PlanSettings settings;
  settings.planner.kind = PlannerKind::RrtConnect;
  for (const double clearance_m : {1e-3, 0.0}) {
    settings.clearance_m = clearance_m;
    const ProblemResult free = planned(wall_problem(), settings).result;
    ASSERT_TRUE(free.solved) << free.reason;
    EXPECT_EQ(free.planner, "RRT-Connect");
    EXPECT_EQ(free.proven, clearance_m > 0);
    EXPECT_GT(free.collision_checks, 0U);
    EXPECT_EQ(collisions_along(*free.waypoints, wall_problem()), 0);
    EXPECT_EQ(planned(wall_problem(), settings).result.waypoints, free.waypoints);
  }
}

TEST(PlanProblem, TheRoadmapAnswersWithAndWithoutGuidanceAndConstraint) {
  PlanSettings settings;
  settings.planner.kind = PlannerKind::Roadmap;
  settings.gate_distance = std::numeric_limits<double>::infinity();
  const Guidance guidance = guidance_towards(Eigen::Vector4d(0, 2.2, 2.2, 0.5));
  for (const QueryGuidance& query :
       {QueryGuidance{}, QueryGuidance{&guidance, SamplingMode::Guided}}) {
    const ProblemResult free = planned(wall_problem(), settings, query).result;
    ASSERT_TRUE(free.solved) << free.reason;
    EXPECT_EQ(free.planner, "Repetition Roadmap");
    EXPECT_EQ(collisions_along(*free.waypoints, wall_problem()), 0);
  }
  const ProblemResult along = planned(line_problem(), settings).result;
  EXPECT_TRUE(along.solved) << along.reason;
}

TEST(PlanProblem, ARoadmapThatLeavesTooManyKernelsToItsTreesSaysSo) {
  PlanSettings settings;
  settings.planner.kind = PlannerKind::Roadmap;
  Guidance guidance = guidance_towards(Eigen::Vector4d(0, 2.2, 2.2, 0.5));
  constexpr Eigen::Index kKernels = 1025;
  guidance.mixture = Mixture(Eigen::VectorXd::Constant(kKernels, 1.0 / kKernels),
                             guidance.mixture->means().col(0).replicate(1, kKernels),
                             {guidance.mixture->covariance(0)});
  const auto planner_with = [&](SamplingMode mode) {
    return planned(wall_problem(), settings, {&guidance, mode}).result.planner;
  };
  EXPECT_EQ(planner_with(SamplingMode::Guided),
            "Repetition Roadmap (trees alone: 1025 components exceed 1024)");
  EXPECT_EQ(planner_with(SamplingMode::Uniform), "Repetition Roadmap");
}

TEST(PlanProblem, APlannerOfOmplStopsWhenAsked) {
  PlanSettings settings;
  settings.planner = ompl_planners::parse_planner("ompl:RRT").value();
  int asked = 0;
  EXPECT_TRUE(plan_problem(planar_robot(), wall_problem(), {}, settings, [&] {
                return ++asked > 10;
              }).interrupted);
}

TEST(PlanProblem, ShortcutsUnderAConstraintKeepTheirBudgetAndShortenThePath) {
  const Problem problem = line_problem();
  PlanSettings direct;
  direct.shortcut_checks = 0;
  const PlannedProblem one = planned(problem, direct), two = planned(problem);
  ASSERT_TRUE(one.result.solved && two.result.solved);
  EXPECT_EQ(one.result.collision_checks, two.result.collision_checks);
  EXPECT_LE(two.result.shortcut_checks, PlanSettings().shortcut_checks);
  EXPECT_LE(planning::path_length(*two.result.waypoints),
            planning::path_length(*one.result.waypoints) + 1e-9);
}

TEST(PlanProblem, AStartOrGoalOutsideTheConstraintIsSaid) {
  Problem problem = line_problem();
  problem.constraint->T_task_region.translation().x() -= 0.25;
  EXPECT_EQ(planned(problem).result.reason,
            "start violates the constraint: x by 0.250000 outside Bw");
  problem = line_problem();
  problem.goal_configurations(3, 0) += 0.5;
  EXPECT_EQ(planned(problem).result.reason, "every goal violates the constraint");
  EXPECT_EQ(planned(problem).outcome, Outcome::Failed);
}

}  // namespace
}  // namespace kinship::guided::plan_problem_test
