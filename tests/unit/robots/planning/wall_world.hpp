#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "robots/planning/birrt.hpp"
#include "robots/planning/is_free.hpp"
#include "robots/planning/path_vertices.hpp"

/// A square of two joints, -1 to 1 each, cut by a wall with one gap: small enough to picture, and
/// hard enough that a straight line does not do.
namespace kinship::planning::test_support {

struct WallWorld {
  double half_thickness = 0.1;
  double gap_lower = 0.6, gap_upper = 0.8;
  std::uint64_t asked = 0;

  bool free_at(const Eigen::VectorXd& q) const {
    const bool in_wall = std::abs(q[0]) < half_thickness;
    return !in_wall || (q[1] > gap_lower && q[1] < gap_upper);
  }

  IsFree is_free() {
    return [this](const Eigen::VectorXd& q) {
      ++asked;
      return free_at(q);
    };
  }

  /// Whether every configuration of a path is free that a check at `step` visits.
  bool path_is_free(const Eigen::MatrixXd& waypoints, double step) const {
    const Eigen::MatrixXd dense = densified(waypoints, step);
    for (Eigen::Index i = 0; i < dense.cols(); ++i)
      if (!free_at(dense.col(i)))
        return false;
    return true;
  }
};

inline Eigen::Matrix2Xd square_bounds() {
  Eigen::Matrix2Xd bounds(2, 2);
  bounds << -1, -1, 1, 1;
  return bounds;
}

inline Eigen::VectorXd at(double x, double y) { return Eigen::Vector2d(x, y); }

// A query through the gap: below it, on either side of the wall.
inline const Eigen::VectorXd kStart = at(-0.8, -0.5);
inline const Eigen::VectorXd kGoal = at(0.8, -0.5);
constexpr double kStep = 0.05;

inline BirrtOptions stepped() {
  BirrtOptions options;
  options.step = kStep;
  return options;
}

}  // namespace kinship::planning::test_support
