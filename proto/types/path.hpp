#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <utility>

namespace kinship {

/// An ordered sequence of waypoints of one chain. Geometry only: a Path carries no times.
///
/// Invariant: at least two waypoints, at least one joint, every value finite.
class Path {
 public:
  /// \param waypoints  dof x n, one column per waypoint, joint units.
  /// \throws std::invalid_argument if the invariant does not hold.
  explicit Path(Eigen::MatrixXd waypoints) : waypoints_(std::move(waypoints)) {
    if (waypoints_.rows() < 1 || waypoints_.cols() < 2 || !waypoints_.allFinite())
      throw std::invalid_argument("Path: need >= 1 joint, >= 2 waypoints, finite values");
  }

  Eigen::Index dof() const noexcept { return waypoints_.rows(); }
  Eigen::Index size() const noexcept { return waypoints_.cols(); }  ///< number of waypoints
  const Eigen::MatrixXd& waypoints() const noexcept { return waypoints_; }

 private:
  Eigen::MatrixXd waypoints_;
};

}  // namespace kinship
