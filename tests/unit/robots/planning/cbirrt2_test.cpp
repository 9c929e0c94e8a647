#include "robots/planning/birrt.hpp"

#include <gtest/gtest.h>

#include "tests/unit/robots/planning/carrying_problem.hpp"

namespace kinship::planning::cbirrt2_test {
namespace {

using test_support::largest_excess;
using test_support::LineArm;
using test_support::make_carrying;

constexpr std::uint64_t kMaxChecks = 50'000;

BirrtOptions options(double step) {
  BirrtOptions options;
  options.step = step;
  options.overshoot = 1;
  options.max_checks = kMaxChecks;
  options.time_limit = std::chrono::minutes(5);  // checks end it, on any machine
  return options;
}

TEST(Cbirrt2, CarriesAContainerUpright) {
  for (const char* robot : {"panda", "ur10e"}) {
    int planned = 0, solved = 0;
    for (std::uint64_t seed = 0; seed < 2; ++seed) {
      auto carrying = make_carrying(robot, seed);
      if (!carrying)
        continue;
      ++planned;
      RegionConstraint constraint = carrying->constraint();
      const ConfigurationSampler sampler(carrying->bounds);
      const IsFree is_free = carrying->is_free();
      std::mt19937_64 generator(seed);
      const PlanSummary summary =
          plan_cbirrt2(carrying->start, carrying->goals, {is_free, constraint}, sampler,
                       options(0.1), generator);
      EXPECT_EQ(summary.collision_checks, carrying->asked);
      EXPECT_EQ(summary.projections, constraint.projections());
      if (!summary.waypoints)
        continue;
      ++solved;
      const Eigen::MatrixXd& path = *summary.waypoints;
      EXPECT_EQ(path.col(0), carrying->start);
      const double nearest_goal =
          (carrying->goals.colwise() - path.rightCols<1>().col(0)).colwise().norm().minCoeff();
      EXPECT_EQ(nearest_goal, 0);
      EXPECT_LE(largest_excess(path, constraint, 1), RegionConstraint::kWaypointTolerance);
      EXPECT_LE(largest_excess(path, constraint, 10), RegionConstraint::kBetweenTolerance);
      for (Eigen::Index i = 0; i < path.cols(); ++i) {
        EXPECT_FALSE(carrying->world.collides(path.col(i)));
        EXPECT_TRUE(carrying->chain.within_limits(path.col(i), 1e-9));
        if (i > 0) {
          EXPECT_LE((path.col(i) - path.col(i - 1)).norm(), 0.1 + 1e-8);
        }
      }
    }
    EXPECT_GE(planned, 1) << robot;
    EXPECT_EQ(solved, planned) << robot;
  }
}

const IsFree everywhere = [](const Eigen::VectorXd&) { return true; };

TEST(Cbirrt2, FollowsAThinRegionAtAnyStep) {
  const LineArm arm;
  for (const double step : {0.02, 0.1, 0.3}) {
    RegionConstraint constraint = arm.constraint();
    std::mt19937_64 generator(1);
    const auto summary =
        plan_cbirrt2(LineArm::at_height(-1), LineArm::at_height(1), {everywhere, constraint},
                     ConfigurationSampler(arm.bounds), options(step), generator);
    ASSERT_TRUE(summary.waypoints) << describe(summary.reason) << " at step " << step;
    EXPECT_LE(largest_excess(*summary.waypoints, constraint, 1),
              RegionConstraint::kWaypointTolerance);
    EXPECT_LE(largest_excess(*summary.waypoints, constraint, 20),
              RegionConstraint::kBetweenTolerance);
  }
}

TEST(Cbirrt2, AskedAboutTheConstraintFirst) {
  const LineArm arm;
  RegionConstraint constraint = arm.constraint();
  std::mt19937_64 generator(1);
  const IsFree never_asked = [](const Eigen::VectorXd&) {
    ADD_FAILURE();
    return true;
  };
  const Eigen::VectorXd off = Eigen::Vector2d(0, 0);
  const ConfigurationSampler sampler(arm.bounds);
  const auto from_outside = plan_cbirrt2(off, LineArm::at_height(1), {never_asked, constraint},
                                         sampler, options(0.1), generator);
  EXPECT_EQ(from_outside.reason, NoPath::StartOffConstraint);
  const auto to_outside = plan_cbirrt2(LineArm::at_height(1), off, {never_asked, constraint},
                                       sampler, options(0.1), generator);
  EXPECT_EQ(to_outside.reason, NoPath::GoalsOffConstraint);
  EXPECT_EQ(to_outside.collision_checks, 0u);
}

TEST(Cbirrt2, AGoalOffTheConstraintIsLeftOut) {
  const LineArm arm;
  RegionConstraint constraint = arm.constraint();
  std::mt19937_64 generator(1);
  Eigen::MatrixXd goals(2, 2);
  goals << Eigen::Vector2d(0, 0), LineArm::at_height(0.5);
  const auto summary = plan_cbirrt2(LineArm::at_height(-0.5), goals, {everywhere, constraint},
                                    ConfigurationSampler(arm.bounds), options(0.1), generator);
  ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
  EXPECT_EQ(summary.waypoints->rightCols<1>(), goals.col(1));
}

TEST(Cbirrt2, EqualSeedEqualPathAndItsLastCheckEndsIt) {
  const LineArm arm;
  const auto plan = [&](std::uint64_t max_checks) {
    RegionConstraint constraint = arm.constraint();
    std::mt19937_64 generator(7);
    BirrtOptions limited = options(0.1);
    limited.max_checks = max_checks;
    const IsFree with_a_gap = [](const Eigen::VectorXd& q) { return std::abs(q[0]) > 0.05; };
    return plan_cbirrt2(LineArm::at_height(-1), LineArm::at_height(0), {with_a_gap, constraint},
                        ConfigurationSampler(arm.bounds), limited, generator);
  };
  const PlanSummary one = plan(1000), two = plan(1000);
  EXPECT_EQ(one.waypoints.has_value(), two.waypoints.has_value());
  EXPECT_EQ(one.collision_checks, two.collision_checks);
  EXPECT_EQ(one.projections, two.projections);
  const PlanSummary cut = plan(5);
  EXPECT_EQ(cut.collision_checks, 5u);
  EXPECT_EQ(cut.reason, NoPath::MaxChecks);
}

}  // namespace
}  // namespace kinship::planning::cbirrt2_test
