#pragma once

#include <Eigen/Core>
#include <optional>

#include "robots/planning/region_constraint.hpp"

namespace kinship::planning {

/// Goes along a region in steps towards a target that may lie outside it. Not shared between
/// threads.
class ConstrainedStepper {
 public:
  /// \param step        longest step, joint units.
  /// \param constraint  must outlive this; counts the projections.
  ConstrainedStepper(double step, RegionConstraint& constraint);

  /// The next configuration on the way: within the waypoint tolerance of the region and nearer to
  /// the target than `q`, at most a step away, the line between within the other tolerance. Where
  /// the region bends too much for a full step, a shorter one. Not checked for collisions.
  /// \param q  holds the constraint.
  /// \return   false if no progress is possible.
  bool advance(const Eigen::VectorXd& q, const Eigen::VectorXd& target, Eigen::VectorXd& next);

  /// All configurations from `from` to `to`, both of which hold the constraint, in such steps.
  /// Not checked for collisions.
  /// \return dof x n, n >= 1; empty if the way gets stuck.
  std::optional<Eigen::MatrixXd> way(const Eigen::VectorXd& from, const Eigen::VectorXd& to);

  /// Whether two configurations that hold the constraint are one step apart.
  bool joins(const Eigen::VectorXd& q, const Eigen::VectorXd& other);

 private:
  bool within_tolerance_between(const Eigen::VectorXd& q, const Eigen::VectorXd& other);

  double step_;
  RegionConstraint& constraint_;
  Eigen::VectorXd middle_;  // kept, so that a step allocates nothing
};

}  // namespace kinship::planning
