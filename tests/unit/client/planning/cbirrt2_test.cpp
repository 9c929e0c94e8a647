#include "client/planning/cbirrt2.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "client/planning/goal_configurations.hpp"
#include "client/planning/planning_bounds.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "tests/support/carrying_cell.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/robots.hpp"

namespace kinship::planning {
namespace {

constexpr std::uint64_t kMaxChecks = 50'000;

BirrtOptions options(double step) {
  BirrtOptions options;
  options.step = step;
  options.overshoot = 1;
  options.max_checks = kMaxChecks;
  options.time_limit = std::chrono::minutes(5);  // checks end it, on any machine
  return options;
}

/// A robot that carries a container, ready to plan.
struct Carrying {
  kinematics::Chain chain;
  test::CarryingCell cell;
  collision::CollisionWorld world;
  Eigen::VectorXd start;
  Eigen::MatrixXd goals;
  Eigen::Matrix2Xd bounds;
  std::uint64_t asked = 0;

  IsFree is_free() {
    return [this](const Eigen::VectorXd& q) {
      ++asked;
      return !world.collides(q);
    };
  }

  RegionConstraint constraint() const {
    return {chain, cell.upright, Eigen::Isometry3d::Identity(), bounds};
  }
};

Eigen::MatrixXd configurations_at(Carrying& carrying, const Eigen::Isometry3d& T_base_transfer) {
  return goal_configurations(carrying.chain, T_base_transfer, carrying.bounds,
                             [&](const Eigen::VectorXd& q) { return !carrying.world.collides(q); })
      .configurations;
}

/// \return empty if the random cell leaves no free start or goal.
std::optional<Carrying> make_carrying(const std::string& robot, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  const kinematics::Chain chain = test::model_chain(robot);
  const auto shapes = geometry::read_shapes(test::model_description(robot), chain).value_or_throw();
  const test::CarryingCell cell = test::make_carrying_cell(chain, generator);
  Carrying carrying = {chain, cell, {chain, shapes, cell.surroundings}, {}, {}, {}};
  carrying.bounds = planning_bounds(chain, (chain.lower() + chain.upper()) / 2);
  const Eigen::MatrixXd starts = configurations_at(carrying, cell.T_base_pick);
  if (starts.cols() == 0)
    return std::nullopt;
  carrying.start = starts.col(0);
  carrying.bounds = planning_bounds(chain, carrying.start);
  carrying.goals = configurations_at(carrying, cell.T_base_place);
  if (carrying.goals.cols() == 0)
    return std::nullopt;
  return carrying;
}

/// The largest excess over the region of what lies on the path, asked by other means than the
/// planner's: many places between waypoints.
double largest_excess(const Eigen::MatrixXd& path, const RegionConstraint& constraint,
                      int parts_per_segment) {
  double largest = 0;
  for (Eigen::Index i = 0; i + 1 < path.cols(); ++i)
    for (int k = 0; k <= parts_per_segment; ++k) {
      const double share = static_cast<double>(k) / parts_per_segment;
      const Eigen::VectorXd q = (1 - share) * path.col(i) + share * path.col(i + 1);
      largest = std::max(largest, constraint.distance(q));
    }
  return largest;
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

/// An arm of two links whose tip keeps to a line, so that its configurations form one curve.
struct LineArm {
  kinematics::Chain chain = test::PlanarArm{{1, 1}}.chain();
  Eigen::Matrix2Xd bounds;
  TaskSpaceRegion line;
  LineArm() {
    bounds.resize(2, 2);
    bounds << -3, -3, 3, 3;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    line.T_task_region.translation().x() = 1.2;
    line.bounds.col(1) << -kInfinity, kInfinity;
    line.bounds.col(5) << -kInfinity, kInfinity;
  }
  RegionConstraint constraint() const {
    return {chain, line, Eigen::Isometry3d::Identity(), bounds};
  }
  /// Tip at (1.2, y), elbow down.
  static Eigen::VectorXd at_height(double y) {
    const double distance = std::hypot(1.2, y);
    const double bend = std::acos(distance / 2);
    return Eigen::Vector2d(std::atan2(y, 1.2) - bend, 2 * bend);
  }
};

const IsFree everywhere = [](const Eigen::VectorXd&) { return true; };

TEST(Cbirrt2, FollowsAThinRegionAtAnyStep) {
  const LineArm arm;
  for (const double step : {0.02, 0.1, 0.3}) {
    RegionConstraint constraint = arm.constraint();
    std::mt19937_64 generator(1);
    const auto summary =
        plan_cbirrt2(LineArm::at_height(-1), LineArm::at_height(1), {everywhere, constraint},
                     ConfigurationSampler(arm.bounds), options(step), generator);
    ASSERT_TRUE(summary.waypoints) << summary.reason << " at step " << step;
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
  EXPECT_EQ(from_outside.reason, "start violates the constraint");
  const auto to_outside = plan_cbirrt2(LineArm::at_height(1), off, {never_asked, constraint},
                                       sampler, options(0.1), generator);
  EXPECT_EQ(to_outside.reason, "every goal violates the constraint");
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
  ASSERT_TRUE(summary.waypoints) << summary.reason;
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
  EXPECT_EQ(cut.reason, "checks");
}

}  // namespace
}  // namespace kinship::planning
