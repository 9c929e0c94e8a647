#pragma once

#include <Eigen/Core>

namespace kinship::kinematics {

/// A rotation from one joint's frame to the next one's, both with their axes along z, as turns:
/// Rz(before) Rx(tilt) Rz(after). The turns about z may be added to the joints' own.
/// Source: Denavit and Hartenberg, A Kinematic Notation for Lower-Pair Mechanisms (1955).
struct AxisTurns {
  double before, after;  ///< rad
  double tilt_sine, tilt_cosine;
};

/// \param R  a rotation; if it keeps the z-axis or reverses it, all of the turn about z is in
///           `after`.
AxisTurns axis_turns(const Eigen::Matrix3d& R);

/// A rotation that takes the z-axis to `axis`, by the smallest angle.
/// \param axis  any length but zero.
Eigen::Matrix3d rotation_of_z_to(const Eigen::Vector3d& axis);

}  // namespace kinship::kinematics
