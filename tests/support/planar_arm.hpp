#pragma once

#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "robots/kinematics/chain.hpp"

namespace kinship::test {

inline TaskAxes planar_axes(bool yaw) { return {{true, true, false, false, false, yaw}}; }

/// Joints about (or, if prismatic, along) their own z, each displaced along x from the one before.
struct PlanarArm {
  std::vector<double> lengths_m;
  double limit = std::numbers::pi;  ///< of every joint, both ways
  kinematics::JointType type = kinematics::JointType::Revolute;
  bool yaw = true;  ///< whether the direction of the tip matters, or its place only
  Eigen::Isometry3d T_tip_transfer = Eigen::Isometry3d::Identity();

  kinematics::Chain chain() const {
    kinematics::ChainParts parts;
    parts.base_link = "base";
    parts.tip_link = "tip";
    for (std::size_t j = 0; j < lengths_m.size(); ++j) {
      kinematics::Joint joint;
      joint.name = "joint" + std::to_string(j);
      joint.type = type;
      if (j > 0)
        joint.T_previous_joint.translation().x() = lengths_m[j - 1];
      joint.lower = -limit;
      joint.upper = limit;
      parts.joints.push_back(joint);
    }
    parts.T_last_tip.translation().x() = lengths_m.back();
    parts.T_tip_transfer = T_tip_transfer;
    parts.task_axes = planar_axes(yaw);
    return kinematics::Chain(std::move(parts));
  }
};

inline Eigen::Isometry3d planar_pose(double x, double y, double yaw_rad) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, 0;
  T.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  return T;
}

}  // namespace kinship::test
