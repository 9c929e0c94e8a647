#include <gtest/gtest.h>

#include <memory>

#include "client/guided/guidance.hpp"
#include "client/guided/plan_problem.hpp"
#include "proto/json/problem_json.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/path_vertices.hpp"
#include "tests/unit/client/planner/planar_problem.hpp"

namespace kinship::guided::plan_problem_by_experience_test {
namespace {

using test::planar_robot;
using test::wall_problem;

PlannedProblem planned(const Problem& problem, const PlanSettings& settings = {},
                       const QueryGuidance& query = {}) {
  return plan_problem(planar_robot(), problem, query, settings, [] { return false; });
}

Eigen::Isometry3d placement_of(const Problem& problem) {
  return problem.T_task_base.value_or(Eigen::Isometry3d::Identity());
}

bool is_free_along(const Eigen::MatrixXd& waypoints, const Problem& problem) {
  const Eigen::MatrixXd path = planning::densified(waypoints, PlanSettings().resolution);
  const PlannedRobot robot = planar_robot();
  collision::CollisionWorld world(robot.solids, {placement_of(problem), problem.scene, {}, {}});
  for (Eigen::Index i = 0; i < path.cols(); ++i)
    if (world.collides(path.col(i)))
      return false;
  return true;
}

/// Guidance by the way that a solved query's hand took.
Guidance experienced(const Problem& problem, const Eigen::MatrixXd& waypoints) {
  const kinematics::Chain chain = planar_robot().chain;
  PosePath path;
  const Eigen::MatrixXd along = planning::densified(waypoints, 0.1);
  for (const auto& q : along.colwise())
    path.poses.push_back(placement_of(problem) * kinematics::T_base_transfer(chain, q));
  TaskExperience experience;
  experience.revision = 77;
  experience.paths = {path};
  Guidance guidance;
  guidance.experience = std::make_shared<planning::ExperienceGuide>(chain, experience);
  guidance.guided_fraction = 1;
  guidance.guide = Guide::Ways;
  return guidance;
}

TEST(PlanProblemByExperience, AStoredWayOfTheHandIsFollowedAndTheResultSaysSo) {
  Problem problem = wall_problem();
  problem.seed += 1;
  PlanSettings by_steps;  // a track that comes nearer to the wall than the clearance ends there
  by_steps.clearance_m = 0;
  const ProblemResult uniform = planned(problem, by_steps).result;
  ASSERT_TRUE(uniform.solved);
  EXPECT_EQ(uniform.found_by, FoundBy::Search);
  const Guidance guidance = experienced(problem, *uniform.waypoints);
  Problem again = problem;
  again.seed += 5;
  PlanSettings tracks_first = by_steps;
  tracks_first.tracks.check_fraction = 1;
  const ProblemResult guided =
      planned(again, tracks_first, {&guidance, SamplingMode::Guided}).result;
  ASSERT_TRUE(guided.solved) << guided.reason;
  EXPECT_EQ(guided.found_by, FoundBy::Track);
  EXPECT_GE(guided.tracks_followed, 1U);
  EXPECT_EQ(guided.experience_revision, 77U);
  EXPECT_GT(guided.track_share, 0);
  EXPECT_EQ(guided.guide, Guide::Ways);
  EXPECT_EQ(guided.share, guided.track_share);
  EXPECT_FALSE(guided.distribution_id);
  EXPECT_TRUE(is_free_along(*guided.waypoints, again));
  EXPECT_LT(guided.collision_checks, planned(again, by_steps).result.collision_checks);

  const ProblemResult control = planned(again, {}, {&guidance, SamplingMode::Control}).result;
  EXPECT_EQ(control.collision_checks, planned(again).result.collision_checks);
  EXPECT_EQ(control.tracks_followed, 0U);
  EXPECT_EQ(control.track_share, 0);
}

TEST(PlanProblemByExperience, TheRetreatNeedsNone) {
  GuidanceOptions wanted;
  wanted.chain = planar_robot().chain;
  wanted.guide = Guide::Retreat;
  const GuidanceAnswer alone = fetch_guidance(nullptr, wanted, std::nullopt);
  const ProblemResult guided =
      planned(wall_problem(), {}, {&*alone.guidance, SamplingMode::Guided}).result;
  ASSERT_TRUE(guided.solved) << guided.reason;
  EXPECT_EQ(guided.guide, Guide::Retreat);
  EXPECT_GE(guided.tracks_followed, 1U);
  EXPECT_GT(guided.track_share, 0);
  const ProblemResult read = json::problem_result_from_json(json::to_json(guided)).value_or_throw();
  EXPECT_EQ(read.sampling_mode, SamplingMode::Guided);
  EXPECT_EQ(read.guide, Guide::Retreat);
}

TEST(PlanProblemByExperience, WhereTheStraightLineIsFreeNoTrackIsFollowed) {
  Problem open = wall_problem();
  const ProblemResult solved = planned(open).result;
  const Guidance guidance = experienced(open, *solved.waypoints);
  open.scene.objects.clear();
  const ProblemResult guided = planned(open, {}, {&guidance, SamplingMode::Guided}).result;
  EXPECT_EQ(guided.found_by, FoundBy::StraightLine);
  EXPECT_EQ(guided.tracks_followed, 0U);
  EXPECT_EQ(guided.collision_checks, planned(open).result.collision_checks);
}

}  // namespace
}  // namespace kinship::guided::plan_problem_by_experience_test
