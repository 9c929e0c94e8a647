#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <string>

#include "robots/geometry/link_shapes.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/planning/region_constraint.hpp"
#include "tests/support/carrying_cell.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/robots.hpp"

/// Problems with a constraint: a cobot that carries upright, and a small arm on a line.
namespace kinship::planning::test_support {

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

inline Eigen::MatrixXd configurations_at(Carrying& carrying,
                                         const Eigen::Isometry3d& T_base_transfer) {
  return goal_configurations(carrying.chain, T_base_transfer, carrying.bounds,
                             [&](const Eigen::VectorXd& q) { return !carrying.world.collides(q); })
      .configurations;
}

/// \return empty if the random cell leaves no free start or goal.
inline std::optional<Carrying> make_carrying(const std::string& robot, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  const kinematics::Chain chain = test::model_chain(robot);
  const auto shapes = geometry::read_shapes(test::robot_model(robot)).value_or_throw();
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
inline double largest_excess(const Eigen::MatrixXd& path, const RegionConstraint& constraint,
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

}  // namespace kinship::planning::test_support
