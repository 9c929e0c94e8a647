#include "robots/planning/repetition_roadmap.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "robots/planning/birrt.hpp"
#include "tests/unit/robots/planning/carrying_problem.hpp"
#include "tests/unit/robots/planning/wall_world.hpp"

namespace kinship::planning::repetition_roadmap_test {
namespace {

using namespace test_support;

RoadmapOptions options() {
  RoadmapOptions options;
  options.tree.step = kStep;
  options.tree.time_limit = std::chrono::minutes(5);  // checks end it, on any machine
  return options;
}

/// Round components of deviation `deviation`.
Mixture round_components(const Eigen::MatrixXd& means, double deviation) {
  const Eigen::MatrixXd covariance =
      deviation * deviation * Eigen::MatrixXd::Identity(means.rows(), means.rows());
  return Mixture(Eigen::VectorXd::Constant(means.cols(), 1 / static_cast<double>(means.cols())),
                 means,
                 std::vector<Eigen::MatrixXd>(static_cast<std::size_t>(means.cols()), covariance));
}

ConfigurationSampler square_sampler(const Mixture& mixture) {
  test::PlanarArm arm;
  arm.lengths_m = {1, 1};
  arm.limit = 1;
  return {square_bounds(), arm.chain(), mixture, 0.9};
}

/// Along a way from start to goal through the gap.
ConfigurationSampler knowing_sampler() {
  Eigen::MatrixXd means(2, 5);
  means << -0.75, -0.6, 0, 0.6, 0.75,  //
      -0.2, 0.4, 0.7, 0.4, -0.2;
  return square_sampler(round_components(means, 0.05));
}

/// Nothing but the inside of the wall.
ConfigurationSampler misled_sampler() {
  Eigen::MatrixXd means(2, 3);
  means << 0, 0, 0, -0.8, -0.3, 0.2;
  return square_sampler(round_components(means, 0.02));
}

PlanSummary plan(WallWorld& world, const Eigen::MatrixXd& goals,
                 const ConfigurationSampler& sampler = knowing_sampler(),
                 const RoadmapOptions& with = options(), std::uint64_t seed = 1) {
  std::mt19937_64 generator(seed);
  return plan_roadmap(kStart, goals, world.is_free(), sampler, with, generator);
}

void expect_law(const WallWorld& world, const PlanSummary& summary) {
  ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
  const Eigen::MatrixXd& path = *summary.waypoints;
  EXPECT_EQ(summary.reason, NoPath::None);
  EXPECT_EQ(summary.collision_checks, world.asked);
  EXPECT_EQ(path.col(0), kStart);
  for (Eigen::Index i = 0; i < path.cols(); ++i) {
    EXPECT_TRUE(world.free_at(path.col(i)));
    if (i > 0) {
      EXPECT_LE((path.col(i) - path.col(i - 1)).norm(), kStep + 1e-9);
      EXPECT_GT((path.col(i) - path.col(i - 1)).norm(), 0);
    }
  }
}

TEST(RepetitionRoadmap, FindsThePathThatItsMixtureKnows) {
  std::uint64_t roadmap_checks = 0, tree_checks = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    WallWorld world;
    const PlanSummary summary = plan(world, kGoal, knowing_sampler(), options(), seed);
    expect_law(world, summary);
    EXPECT_EQ(summary.waypoints->rightCols<1>(), kGoal);
    EXPECT_EQ(summary.iterations, 0u) << "needed its trees";
    roadmap_checks += summary.collision_checks;
    std::mt19937_64 generator(seed);
    tree_checks += plan_birrt(kStart, kGoal, world.is_free(), ConfigurationSampler(square_bounds()),
                              options().tree, generator)
                       .collision_checks;
  }
  EXPECT_LT(2 * roadmap_checks, tree_checks);
}

TEST(RepetitionRoadmap, FallsBackToTheTreesWhereTheMixtureIsWrong) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    WallWorld world;
    const PlanSummary summary = plan(world, kGoal, misled_sampler(), options(), seed);
    expect_law(world, summary);
    EXPECT_GT(summary.iterations, 0u);
  }
}

TEST(RepetitionRoadmap, PathsThroughBegunTreesKeepTheLaw) {
  // The mixture leads into the gap from both sides but never through a bend in it.
  Eigen::MatrixXd means(2, 4);
  means << -0.7, -0.15, 0.15, 0.7, 0.2, 0.7, 0.7, 0.2;
  WallWorld world;
  world.gap_upper = 0.62;
  const PlanSummary summary = plan(world, kGoal, square_sampler(round_components(means, 0.01)));
  expect_law(world, summary);
  EXPECT_GT(summary.iterations, 0u);
}

TEST(RepetitionRoadmap, ItsShareOfTheChecksIsAllItSpends) {
  RoadmapOptions none = options();
  none.max_roadmap_checks = 0;
  WallWorld world;
  const PlanSummary summary = plan(world, kGoal, knowing_sampler(), none);
  expect_law(world, summary);
  EXPECT_GT(summary.iterations, 0u);
}

TEST(RepetitionRoadmap, StopsAtItsLastCheck) {
  for (const std::uint64_t limit : {0u, 1u, 2u, 3u, 30u, 500u}) {
    WallWorld world;
    world.gap_upper = world.gap_lower;  // no gap: never solved
    RoadmapOptions limited = options();
    limited.tree.max_checks = limit;
    const PlanSummary summary = plan(world, kGoal, knowing_sampler(), limited);
    EXPECT_EQ(world.asked, limit);
    EXPECT_EQ(summary.collision_checks, limit);
    EXPECT_EQ(summary.reason, NoPath::MaxChecks);
    EXPECT_FALSE(summary.waypoints);
  }
}

TEST(RepetitionRoadmap, EqualSeedEqualPath) {
  WallWorld world;
  for (const auto& sampler : {knowing_sampler(), misled_sampler()}) {
    const PlanSummary one = plan(world, kGoal, sampler), two = plan(world, kGoal, sampler);
    ASSERT_TRUE(one.waypoints && two.waypoints);
    EXPECT_EQ(*one.waypoints, *two.waypoints);
    EXPECT_EQ(one.collision_checks, two.collision_checks);
  }
}

TEST(RepetitionRoadmap, OneComponentIsEnough) {
  WallWorld world;
  expect_law(world, plan(world, kGoal, square_sampler(round_components(at(0, 0.7), 0.05))));
}

TEST(RepetitionRoadmap, WithoutAMixtureItIsTheTrees) {
  WallWorld world;
  const ConfigurationSampler uniform(square_bounds());
  const PlanSummary summary = plan(world, kGoal, uniform);
  std::mt19937_64 generator(1);
  const PlanSummary trees =
      plan_birrt(kStart, kGoal, world.is_free(), uniform, options().tree, generator);
  ASSERT_TRUE(summary.waypoints && trees.waypoints);
  EXPECT_EQ(*summary.waypoints, *trees.waypoints);
}

/// Kernels at points between start and goal.
Mixture kernels(Eigen::Index count) {
  Eigen::MatrixXd means(2, count);
  means.row(0).setLinSpaced(-0.8, 0.8);
  means.row(1).setConstant(0.7);
  return {Eigen::VectorXd::Constant(count, 1 / static_cast<double>(count)),
          means,
          {0.0025 * Eigen::Matrix2d::Identity()}};
}

TEST(RepetitionRoadmap, KernelsAreComponents) {
  WallWorld world;
  expect_law(world, plan(world, kGoal, square_sampler(kernels(12))));
}

TEST(RepetitionRoadmap, WithTooManyComponentsItIsTheGuidedTrees) {
  WallWorld world;
  const ConfigurationSampler guided = square_sampler(kernels(kMaxRoadmapComponents + 1));
  const PlanSummary summary = plan(world, kGoal, guided);
  std::mt19937_64 generator(1);
  const PlanSummary trees =
      plan_birrt(kStart, kGoal, world.is_free(), guided, options().tree, generator);
  ASSERT_TRUE(summary.waypoints && trees.waypoints);
  EXPECT_EQ(*summary.waypoints, *trees.waypoints);
}

TEST(RepetitionRoadmap, GoalsWithinReach) {
  WallWorld world;
  Eigen::MatrixXd goals(2, 3);
  goals << at(0, 0), at(-0.7, -0.4), kGoal;  // in the wall, in sight, behind the wall
  const PlanSummary near = plan(world, goals);
  expect_law(world, near);
  EXPECT_EQ(near.waypoints->rightCols<1>(), goals.col(1));
  goals.col(2) = kStart;
  const PlanSummary there = plan(world, goals);
  ASSERT_TRUE(there.waypoints);
  EXPECT_EQ(there.waypoints->cols(), 2);
}

TEST(RepetitionRoadmap, SaysWhyItDidNotPlan) {
  WallWorld world;
  EXPECT_EQ(plan(world, at(0, 0)).reason, NoPath::GoalsCollide);
  EXPECT_EQ(plan(world, Eigen::MatrixXd(2, 0)).reason, NoPath::NoGoal);
  world.half_thickness = 0.9;
  EXPECT_EQ(plan(world, kGoal).reason, NoPath::StartCollides);
  RoadmapOptions negative = options();
  negative.draws = -1;
  EXPECT_THROW(plan(world, kGoal, knowing_sampler(), negative), std::invalid_argument);
}

TEST(RepetitionRoadmap, VerticesComeToTheTurnOfTheStart) {
  test::PlanarArm arm;
  arm.lengths_m = {1, 1};
  arm.limit = 2 * M_PI;
  const kinematics::Chain chain = arm.chain();
  const Eigen::VectorXd start = at(4, 0), goal = at(5.5, 0);
  const Eigen::Matrix2Xd bounds = planning_bounds(chain, start);
  // A wall between start and goal, with a gap that the mixture knows a turn below.
  const auto in_gap = [](const Eigen::VectorXd& q) {
    return std::abs(q[0] - 4.75) > 0.1 || (q[1] > 1.5 && q[1] < 1.6);
  };
  Eigen::MatrixXd means(2, 3);
  means << 4.5, 4.75, 5.0, 1.55, 1.55, 1.55;
  means.row(0).array() -= 2 * M_PI;
  const ConfigurationSampler sampler(bounds, chain, round_components(means, 0.01), 0.9);
  std::mt19937_64 generator(1);
  const PlanSummary summary = plan_roadmap(start, goal, in_gap, sampler, options(), generator);
  ASSERT_TRUE(summary.waypoints);
  EXPECT_EQ(summary.iterations, 0u);
}

TEST(RepetitionRoadmap, FollowsAThinRegion) {
  const LineArm arm;
  Eigen::MatrixXd means(2, 3);
  means << LineArm::at_height(-0.5), LineArm::at_height(0), LineArm::at_height(0.5);
  const ConfigurationSampler sampler(arm.bounds, arm.chain, round_components(means, 0.1), 0.9);
  RegionConstraint constraint = arm.constraint();
  std::uint64_t asked = 0;
  const IsFree is_free = [&](const Eigen::VectorXd&) {
    ++asked;
    return true;
  };
  std::mt19937_64 generator(1);
  const PlanSummary summary =
      plan_roadmap(LineArm::at_height(-1), LineArm::at_height(1),
                   ConstrainedFreedom{is_free, constraint}, sampler, options(), generator);
  ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
  EXPECT_EQ(summary.iterations, 0u);
  EXPECT_EQ(summary.collision_checks, asked);
  EXPECT_EQ(summary.projections, constraint.projections());
  EXPECT_LE(largest_excess(*summary.waypoints, constraint, 1),
            RegionConstraint::kWaypointTolerance);
  EXPECT_LE(largest_excess(*summary.waypoints, constraint, 20),
            RegionConstraint::kBetweenTolerance);
  const Eigen::VectorXd off = Eigen::Vector2d(0, 0);
  EXPECT_EQ(plan_roadmap(off, LineArm::at_height(1), ConstrainedFreedom{is_free, constraint},
                         sampler, options(), generator)
                .reason,
            NoPath::StartOffConstraint);
}

TEST(RepetitionRoadmap, CarriesAContainerAsBefore) {
  auto carrying = make_carrying("panda", 0);
  ASSERT_TRUE(carrying);
  RegionConstraint constraint = carrying->constraint();
  const IsFree is_free = carrying->is_free();
  const ConstrainedFreedom freedom{is_free, constraint};
  std::mt19937_64 generator(4);
  RoadmapOptions with = options();
  with.tree.step = 0.1;
  const PlanSummary first =
      plan_cbirrt2(carrying->start, carrying->goals, freedom,
                   ConfigurationSampler(carrying->bounds), with.tree, generator);
  ASSERT_TRUE(first.waypoints);
  Eigen::MatrixXd means(carrying->chain.dof(), (first.waypoints->cols() + 3) / 4);
  for (Eigen::Index k = 0; k < means.cols(); ++k)
    means.col(k) = first.waypoints->col(4 * k);
  const ConfigurationSampler sampler(carrying->bounds, carrying->chain,
                                     round_components(means, 0.05), 0.9);
  carrying->asked = 0;
  const PlanSummary again =
      plan_roadmap(carrying->start, carrying->goals, freedom, sampler, with, generator);
  ASSERT_TRUE(again.waypoints) << describe(again.reason);
  EXPECT_EQ(again.iterations, 0u);
  EXPECT_EQ(again.collision_checks, carrying->asked);
  EXPECT_LT(again.collision_checks, first.collision_checks);
  EXPECT_LE(largest_excess(*again.waypoints, constraint, 10), RegionConstraint::kBetweenTolerance);
  for (const auto& q : again.waypoints->colwise()) {
    EXPECT_TRUE(constraint.holds(q));
    EXPECT_FALSE(carrying->world.collides(q));
  }
}

}  // namespace
}  // namespace kinship::planning::repetition_roadmap_test
