#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "tests/unit/client/planner/plan_problem_answers.hpp"

namespace kinship::guided::plan_problem_test {
namespace {

TEST(PlanProblemProven, APathIsProvenUnlessStepsAreAskedFor) {
  const ProblemResult proven = planned(wall_problem()).result;
  ASSERT_TRUE(proven.solved);
  EXPECT_TRUE(proven.proven);
  PlanSettings by_steps;
  by_steps.clearance_m = 0;
  const ProblemResult stepped = planned(wall_problem(), by_steps).result;
  ASSERT_TRUE(stepped.solved);
  EXPECT_FALSE(stepped.proven);
  EXPECT_FALSE(stepped.least_clearance_m);
  EXPECT_EQ(stepped.refuted_edges, 0U);
}

/// Between the start and the goal stands a plate that is thinner than a step.
TEST(PlanProblemProven, NoPathLeadsThroughAThinPlate) {
  Problem problem = wall_problem();
  for (SceneObject& wall : problem.scene.objects)
    wall.shape = BoxShape{std::get<BoxShape>(wall.shape).size.cwiseMin(0.004)};
  std::uint64_t refuted = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    problem.seed = seed;
    const ProblemResult result = planned(problem).result;
    ASSERT_TRUE(result.solved) << result.reason;
    EXPECT_EQ(collisions_along(*result.waypoints, problem, 1e-3), 0) << seed;
    refuted += result.refuted_edges;
  }
  EXPECT_GT(refuted, 0U);
}

TEST(PlanProblemProven, AStartNearerThanTheClearanceIsNamedWithItsDistance) {
  Problem problem = wall_problem();
  problem.start = Eigen::Vector4d(0.12, 0, 0, 0);  // some 14 mm beside the wall
  EXPECT_TRUE(planned(problem).result.solved);
  PlanSettings wide;
  wide.clearance_m = 0.05;
  const ProblemResult result = planned(problem, wide).result;
  EXPECT_FALSE(result.solved);
  EXPECT_EQ(result.not_planned, NotPlanned::StartCollides);
  EXPECT_NE(result.reason.find("nearer than the clearance of 50 mm"), std::string::npos)
      << result.reason;
}

TEST(PlanProblemProven, WhatIsTooNearIsNamedAmongWhatTouches) {
  Problem problem = wall_problem();
  problem.goal_configurations.resize(4, 3);
  problem.goal_configurations << 0.12, 0.12, 0, Eigen::Matrix3d::Zero();  // 14 mm beside, and in it
  PlanSettings wide;
  wide.clearance_m = 0.05;
  const std::string reason = planned(problem, wide).result.reason;
  EXPECT_NE(reason.find("is less than 50 mm from 'wall' in 2 of 3"), std::string::npos) << reason;
  EXPECT_NE(reason.find("touches 'wall' in 1 of 3"), std::string::npos) << reason;
}

}  // namespace
}  // namespace kinship::guided::plan_problem_test
