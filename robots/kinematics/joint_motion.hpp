#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "robots/kinematics/chain.hpp"

namespace kinship::kinematics {

/// Rotation by an angle about a unit axis.
/// Source: Rodrigues' formula; Siciliano et al., Robotics (2009), eq. 2.25.
inline Eigen::Matrix3d rotation_about(const Eigen::Vector3d& axis, double angle_rad) {
  const double s = std::sin(angle_rad), c = std::cos(angle_rad), v = 1 - c;
  const double x = axis.x(), y = axis.y(), z = axis.z();
  Eigen::Matrix3d R;
  R << x * x * v + c, x * y * v - z * s, x * z * v + y * s,  //
      x * y * v + z * s, y * y * v + c, y * z * v - x * s,   //
      x * z * v - y * s, y * z * v + x * s, z * z * v + c;
  return R;
}

/// Moves a frame from one joint's moving frame to the next joint's frame at zero.
inline void follow(const Eigen::Isometry3d& T_previous_joint, Eigen::Isometry3d& T_base_frame) {
  const Eigen::Matrix3d R = T_base_frame.linear();
  T_base_frame.translation() += R * T_previous_joint.translation();
  T_base_frame.linear().noalias() = R * T_previous_joint.linear();
}

/// Moves a joint's frame at zero to its moving frame at `value`, joint units.
inline void move(const Joint& joint, double value, Eigen::Isometry3d& T_base_frame) {
  const Eigen::Matrix3d R = T_base_frame.linear();
  if (joint.type == JointType::Prismatic)
    T_base_frame.translation() += value * (R * joint.axis);
  else
    T_base_frame.linear().noalias() = R * rotation_about(joint.axis, value);
}

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
