#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <variant>

#include "client/guided/path_measures.hpp"
#include "robots/collision/edge_prover.hpp"
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
  EXPECT_EQ(stepped.refuted_edges, 0U);
}

TEST(PlanProblemProven, APathIsMeasuredAlikeWhetherProvenOrNot) {
  const Problem problem = wall_problem();
  const PlannedRobot robot = planar_robot();
  collision::CollisionWorld world(robot.solids, {placement_of(problem), problem.scene, {}, {}});
  collision::EdgeProver prover(world);
  PlanSettings by_steps;
  by_steps.clearance_m = 0;
  for (const PlanSettings& settings : {PlanSettings(), by_steps}) {
    ProblemResult result = planned(problem, settings).result;
    ASSERT_TRUE(result.solved);
    EXPECT_FALSE(result.path_length) << "of its own accord nobody measures";
    measure_path(robot, problem, result);
    EXPECT_EQ(result.path_length, planning::path_length(*result.waypoints));
    EXPECT_EQ(result.hand_length_m, planning::hand_length_m(robot.chain, *result.waypoints));
    double nearest_m = 0.1;
    const Eigen::MatrixXd dense = planning::densified(*result.waypoints, planning::kMeasuredStep);
    for (const auto& q : dense.colwise())
      for (const collision::NearPair& pair : prover.find_near(q, {.clearance_m = nearest_m}))
        if (pair.first == "wall" || pair.second == "wall")
          nearest_m = std::min(nearest_m, pair.clearance_m);
    EXPECT_NEAR(result.least_clearance_m.value(), nearest_m, 0.02 * nearest_m);
  }
}

TEST(PlanProblemProven, WithoutAPathNothingIsMeasured) {
  ProblemResult result;
  measure_path(planar_robot(), wall_problem(), result);
  EXPECT_FALSE(result.path_length || result.hand_length_m || result.least_clearance_m);
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
