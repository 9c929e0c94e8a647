#include "robots/planning/birrt.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>

#include "tests/support/planar_arm.hpp"
#include "tests/unit/robots/planning/wall_world.hpp"

namespace kinship::planning::birrt_test {
namespace {

using namespace test_support;

PlanSummary plan(WallWorld& world, const Eigen::MatrixXd& goals, std::uint64_t seed,
                 const BirrtOptions& with = stepped(),
                 const ConfigurationSampler& sampler = ConfigurationSampler(square_bounds())) {
  std::mt19937_64 generator(seed);
  return plan_birrt(kStart, goals, world.is_free(), sampler, with, generator);
}

TEST(Birrt, FindsFreePathsWithTheRightEndsAndStep) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    WallWorld world;
    const PlanSummary summary = plan(world, kGoal, seed);
    ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
    const Eigen::MatrixXd& path = *summary.waypoints;
    EXPECT_EQ(path.col(0), kStart);
    EXPECT_EQ(path.rightCols(1), kGoal);
    EXPECT_TRUE(world.path_is_free(path, kStep));
    for (Eigen::Index i = 1; i < path.cols(); ++i) {
      EXPECT_LE((path.col(i) - path.col(i - 1)).norm(), kStep + 1e-9);
      EXPECT_GT((path.col(i) - path.col(i - 1)).norm(), 0);
    }
    EXPECT_EQ(summary.reason, NoPath::None);
  }
}

TEST(Birrt, AStartThatIsAGoalIsAPathOfTwoEqualWaypoints) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    WallWorld world;
    Eigen::MatrixXd goals(2, 2);
    goals << kGoal, kStart;
    const PlanSummary summary = plan(world, goals, seed);
    ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
    ASSERT_EQ(summary.waypoints->cols(), 2);
    EXPECT_EQ(summary.waypoints->col(0), kStart);
    EXPECT_EQ(summary.waypoints->col(1), kStart);
    EXPECT_EQ(summary.iterations, 0U);
  }
}

TEST(Birrt, GoesStraightToTheNearestGoalThatNothingHides) {
  Eigen::MatrixXd goals(2, 3);
  goals << at(0.8, -0.5), at(-0.8, 0.9), at(-0.8, 0.8);  // behind the wall, on this side twice
  WallWorld world;
  const PlanSummary summary = plan(world, goals, 1);
  ASSERT_TRUE(summary.waypoints);
  EXPECT_EQ(summary.iterations, 0U) << "no sample was needed";
  EXPECT_EQ(summary.waypoints->rightCols(1), goals.col(2));
  EXPECT_EQ(summary.waypoints->row(0).minCoeff(), summary.waypoints->row(0).maxCoeff());
  EXPECT_EQ(summary.collision_checks, world.asked);
  EXPECT_EQ(summary.collision_checks, 1U + 3 + 26) << "start, goals, 1.3 in steps of 0.05";
}

TEST(Birrt, AMixtureThatCoversNoWayOutDelaysAPathButNeverPreventsIt) {
  const Mixture beside_the_start(Eigen::VectorXd::Ones(1), kStart,
                                 {1e-4 * Eigen::MatrixXd::Identity(2, 2)});
  const ConfigurationSampler sampler(square_bounds(), test::PlanarArm{{0.5, 0.5}}.chain(),
                                     beside_the_start, 1);
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    WallWorld world;
    const PlanSummary summary = plan(world, kGoal, seed, stepped(), sampler);
    ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
    EXPECT_GT(summary.iterations, 300U);
  }
}

TEST(Birrt, EndsInAnyOfTheGoals) {
  Eigen::MatrixXd goals(2, 3);
  goals << at(0, 0), at(0.8, -0.5), at(-0.8, 0.9);  // in the wall, behind it, on this side
  WallWorld world;
  const PlanSummary summary = plan(world, goals, 2);
  ASSERT_TRUE(summary.waypoints);
  const Eigen::VectorXd end = summary.waypoints->rightCols(1);
  EXPECT_TRUE(end == goals.col(1) || end == goals.col(2));
}

TEST(Birrt, SamplesInTheGapMakeItFast) {
  test::PlanarArm arm;
  arm.lengths_m = {1, 1};
  arm.limit = 1;
  const Mixture gap(Eigen::VectorXd::Ones(1), at(0, 0.7), {Eigen::MatrixXd::Identity(2, 2) * 0.01});
  const ConfigurationSampler guided(square_bounds(), arm.chain(), gap, 0.9);
  std::uint64_t uniform_checks = 0, guided_checks = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    WallWorld world;
    world.gap_upper = 0.66;
    uniform_checks += plan(world, kGoal, seed).collision_checks;
    guided_checks += plan(world, kGoal, seed, stepped(), guided).collision_checks;
  }
  EXPECT_LT(2 * guided_checks, uniform_checks);
}

TEST(Birrt, SaysWhyItDidNotPlan) {
  WallWorld world;
  EXPECT_EQ(plan(world, at(0, 0), 0).reason, NoPath::GoalsCollide);
  EXPECT_EQ(plan(world, Eigen::MatrixXd(2, 0), 0).reason, NoPath::NoGoal);
  world.half_thickness = 0.9;
  const PlanSummary blocked = plan(world, kGoal, 0);
  EXPECT_EQ(blocked.reason, NoPath::StartCollides);
  EXPECT_FALSE(blocked.waypoints);
  EXPECT_EQ(blocked.collision_checks, 1u);
}

TEST(Birrt, StopsAtItsLastCheck) {
  for (const std::uint64_t limit : {0u, 1u, 2u, 3u, 500u}) {
    WallWorld world;
    world.gap_upper = world.gap_lower;  // no gap: never solved
    BirrtOptions limited = stepped();
    limited.max_checks = limit;
    const PlanSummary summary = plan(world, kGoal, 4, limited);
    EXPECT_EQ(world.asked, limit);
    EXPECT_EQ(summary.collision_checks, limit);
    EXPECT_EQ(summary.reason, NoPath::MaxChecks);
    EXPECT_FALSE(summary.waypoints);
  }
}

TEST(Birrt, StopsInTime) {
  WallWorld world;
  world.gap_upper = world.gap_lower;
  BirrtOptions limited = stepped();
  limited.max_checks = std::numeric_limits<std::uint64_t>::max();
  limited.time_limit = std::chrono::milliseconds(20);
  const auto begin = std::chrono::steady_clock::now();
  const PlanSummary summary = plan(world, kGoal, 5, limited);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(summary.reason, NoPath::TimeLimit);
  EXPECT_GE(elapsed.count(), 0.02);
  EXPECT_GT(summary.planning_time_s, 0);
  EXPECT_LE(summary.planning_time_s, elapsed.count() + 1e-3);  // CPU time of this thread
}

TEST(Birrt, StaysWithinItsBounds) {
  WallWorld world;
  std::mt19937_64 generator(6);
  BirrtOptions far = stepped();
  far.overshoot = 10;
  const IsFree is_free = [&](const Eigen::VectorXd& q) {
    EXPECT_LE(q.cwiseAbs().maxCoeff(), 1 + 1e-9);
    return world.free_at(q);
  };
  const ConfigurationSampler sampler(square_bounds());
  EXPECT_TRUE(plan_birrt(kStart, kGoal, is_free, sampler, far, generator).waypoints);
}

TEST(Birrt, RefusesWhatDoesNotFit) {
  WallWorld world;
  EXPECT_THROW(plan(world, Eigen::MatrixXd::Zero(3, 1), 0), std::invalid_argument);
  EXPECT_THROW(plan(world, at(0, NAN), 0), std::invalid_argument);
  BirrtOptions wrong = stepped();
  wrong.step = 0;
  EXPECT_THROW(plan(world, kGoal, 0, wrong), std::invalid_argument);
  wrong = stepped();
  wrong.overshoot = 0.5;
  EXPECT_THROW(plan(world, kGoal, 0, wrong), std::invalid_argument);
}

TEST(Birrt, PlansTheSameWhetherItAsksForOneOrForSeveralAtOnce) {
  WallWorld world;
  std::uint64_t asked = 0;
  const IsFree one_by_one = world.is_free();
  const IsFree together([&](const Eigen::VectorXd& q) { return one_by_one(q); },
                        [&](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
                          ++asked;
                          return one_by_one.ahead(qs);
                        });
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const PlanSummary expected = plan(world, kGoal, seed);
    std::mt19937_64 generator(seed);
    const PlanSummary summary = plan_birrt(
        kStart, kGoal, together, ConfigurationSampler(square_bounds()), stepped(), generator);
    ASSERT_TRUE(summary.waypoints && expected.waypoints);
    EXPECT_EQ(*summary.waypoints, *expected.waypoints);
    EXPECT_EQ(summary.collision_checks, expected.collision_checks);
    EXPECT_LT(asked, summary.collision_checks);
    asked = 0;
  }
}

}  // namespace
}  // namespace kinship::planning::birrt_test
