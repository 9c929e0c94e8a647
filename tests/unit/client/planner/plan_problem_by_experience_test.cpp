#include <gtest/gtest.h>

#include <memory>

#include "client/guided/guidance.hpp"
#include "client/guided/plan_problem.hpp"
#include "proto/json/problem_json.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/path_vertices.hpp"
#include "robots/recall/clear_path.hpp"
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

/// Guidance by one whole path that once answered the problem.
Guidance recalling(const Problem& problem, const Eigen::MatrixXd& waypoints) {
  RecallLibrary library;
  library.revision = 5;
  library.search_checks = 1e6;
  library.try_checks = 10;
  RecallQuery& query = library.queries.emplace_back();
  query.report = Uuid::random();
  query.T_task_base = placement_of(problem);
  query.start = waypoints.col(0);
  query.goal = waypoints.rightCols<1>();
  library.paths.push_back({0, recall::equal_parts(waypoints)});
  library.modes = {{0, kTaskFrame}};
  library.solves = library.reaches = {0};
  EXPECT_FALSE(validate(library));
  Guidance guidance;
  guidance.recall = std::make_shared<recall::RecallGuide>(planar_robot().chain, library);
  guidance.guided_fraction = 1;
  guidance.guide = Guide::Recall;
  return guidance;
}

/// A path around the wall with room for the places between its 32 waypoints.
Eigen::MatrixXd roomy_path(const Problem& problem) {
  PlanSettings roomy;
  roomy.clearance_m = 0.02;
  return planned(problem, roomy).result.waypoints.value();
}

TEST(PlanProblemByExperience, AWholePathIsRecalledWithoutASearch) {
  const Problem problem = wall_problem();
  const Guidance guidance = recalling(problem, roomy_path(problem));
  Problem again = problem;
  again.start[0] += 0.03;
  again.goal_configurations(1, 0) += 0.03;
  const PlannedProblem recalled = planned(again, {}, {&guidance, SamplingMode::Guided});
  const ProblemResult& result = recalled.result;
  ASSERT_TRUE(result.solved) << result.reason;
  EXPECT_EQ(recalled.outcome, Outcome::Solved);
  EXPECT_EQ(result.found_by, FoundBy::Recalled);
  EXPECT_EQ(result.recall_tries, 1U);
  EXPECT_EQ(result.guide, Guide::Recall);
  EXPECT_EQ(result.tracks_followed, 0U);
  EXPECT_FALSE(result.not_planned);
  EXPECT_TRUE(result.proven);
  EXPECT_EQ(result.waypoints->col(0), again.start);
  EXPECT_EQ(result.waypoints->rightCols<1>(), again.goal_configurations);
  EXPECT_TRUE(is_free_along(*result.waypoints, again));
  EXPECT_LT(result.collision_checks, planned(again).result.collision_checks / 2);
  const ProblemResult read = json::problem_result_from_json(json::to_json(result)).value_or_throw();
  EXPECT_EQ(read.recall_tries, 1U);
  EXPECT_EQ(read.found_by, FoundBy::Recalled);
}

TEST(PlanProblemByExperience, AGoalPoseIsReachedByARecalledPath) {
  Problem problem = wall_problem();
  const Guidance guidance = recalling(problem, roomy_path(problem));
  problem.T_task_goal =
      kinematics::T_base_transfer(planar_robot().chain, problem.goal_configurations);
  problem.goal_configurations.resize(4, 0);
  const ProblemResult result = planned(problem, {}, {&guidance, SamplingMode::Guided}).result;
  ASSERT_TRUE(result.solved) << result.reason;
  EXPECT_EQ(result.found_by, FoundBy::Recalled);
  EXPECT_EQ(result.goal_checks, 0U) << "its goal configurations are not needed";
  EXPECT_TRUE(kinematics::T_base_transfer(planar_robot().chain, result.waypoints->rightCols<1>())
                  .isApprox(*problem.T_task_goal, 1e-5));
}

TEST(PlanProblemByExperience, WhereNoRecalledPathIsFreeASearchFollows) {
  const Problem problem = wall_problem();
  Eigen::MatrixXd through_the_wall(4, 2);
  through_the_wall << problem.start, problem.goal_configurations;
  const Guidance guidance = recalling(problem, through_the_wall);
  const PlannedProblem searched = planned(problem, {}, {&guidance, SamplingMode::Guided});
  const ProblemResult& result = searched.result;
  ASSERT_TRUE(result.solved) << result.reason;
  EXPECT_EQ(result.found_by, FoundBy::Search);
  EXPECT_EQ(result.recall_tries, 1U);
  EXPECT_GT(searched.recall_expected, 0);
  EXPECT_TRUE(is_free_along(*result.waypoints, problem));
  const ProblemResult uniform = planned(problem).result;
  EXPECT_EQ(*result.waypoints, *uniform.waypoints) << "the same search";
  EXPECT_GT(result.collision_checks, uniform.collision_checks) << "and what the try cost";
}

TEST(PlanProblemByExperience, NothingIsRecalledForControlWithoutTheGuideOrWithoutTrust) {
  const Problem problem = wall_problem();
  Guidance guidance = recalling(problem, roomy_path(problem));
  const auto tries = [&](const QueryGuidance& query) {
    const ProblemResult result = planned(problem, {}, query).result;
    EXPECT_TRUE(result.solved);
    EXPECT_NE(result.found_by, FoundBy::Recalled);
    return result.recall_tries;
  };
  EXPECT_EQ(tries({&guidance, SamplingMode::Control}), 0U);
  EXPECT_EQ(tries({&guidance, SamplingMode::Guided, 0}), 0U);
  guidance.guide = Guide::RetreatWaysMixture;
  EXPECT_EQ(tries({&guidance, SamplingMode::Guided}), 0U);
}

}  // namespace
}  // namespace kinship::guided::plan_problem_by_experience_test
