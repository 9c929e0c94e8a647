#pragma once

#include <Eigen/Core>

namespace kinship {

/// An ordered sequence of waypoints of one chain. Geometry only: a Path carries no times.
///
/// Invariant: at least two waypoints, at least one joint, every value finite.
class Path {
 public:
  /// \param waypoints  dof x n, one column per waypoint, joint units.
  /// \throws std::invalid_argument if the invariant does not hold, naming the first number that is
  ///         not finite.
  explicit Path(Eigen::MatrixXd waypoints);

  Eigen::Index dof() const noexcept { return waypoints_.rows(); }
  Eigen::Index size() const noexcept { return waypoints_.cols(); }  ///< number of waypoints
  const Eigen::MatrixXd& waypoints() const noexcept { return waypoints_; }

 private:
  Eigen::MatrixXd waypoints_;
};

}  // namespace kinship
