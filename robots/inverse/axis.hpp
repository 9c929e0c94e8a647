#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "robots/kinematics/chain.hpp"
#include "robots/kinematics/joint_motion.hpp"

namespace kinship::inverse {

/// A rigid displacement x -> R x + p.
struct Displacement {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator()(const Eigen::Vector3d& x) const { return R * x + p; }

  Displacement operator*(const Displacement& right) const { return {R * right.R, R * right.p + p}; }

  Displacement inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
};

/// The axis that a joint turns about or slides along: a line in the base link, with every joint at
/// 0. It does not depend on the joint's own frame: lines meet wherever the joints' origins lie.
struct Axis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit vector
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< any point of the line
  bool prismatic = false;

  /// The point of the line nearest to x.
  Eigen::Vector3d foot_of(const Eigen::Vector3d& x) const {
    return point + direction * direction.dot(x - point);
  }

  /// The displacement by a joint value.
  /// Source: Lynch and Park, Modern Robotics (2017), eq. 3.88.
  Displacement at(double value) const {
    if (prismatic)
      return {Eigen::Matrix3d::Identity(), value * direction};
    const Eigen::Matrix3d R = kinematics::rotation_about(direction, value);
    return {R, point - R * point};
  }

  /// The line after a displacement.
  Axis moved(const Displacement& by) const { return {by.R * direction, by(point), prismatic}; }
};

/// Shortest distance between two lines.
double distance_between(const Axis& a, const Axis& b);

/// A chain as a product of exponentials: the pose of the transfer frame is the product of the axes'
/// displacements, from base to tip, times `T_base_transfer` at zero. Lengths are in units of
/// `scale_m`, about the arm's reach, so that tolerances are the same for arms of every size.
struct AxisChain {
  std::vector<Axis> axes;        ///< one per joint, from base to tip
  Displacement T_base_transfer;  ///< with every joint at 0
  double scale_m = 1;
};

/// The axes of a chain; fixed joints, base and transfer frame are folded in.
AxisChain axes_of(const kinematics::Chain& chain);

}  // namespace kinship::inverse
