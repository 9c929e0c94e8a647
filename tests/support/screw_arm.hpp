#pragma once

#include <Eigen/Geometry>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "robots/kinematics/chain.hpp"

namespace kinship::test {

/// A joint of an arm that is given by its lines while every joint stands at 0.
struct Line {
  Eigen::Vector3d point;      ///< m, in the base link
  Eigen::Vector3d direction;  ///< of any length
  kinematics::JointType type = kinematics::JointType::Revolute;
};

/// The chain whose joints turn about lines. Every frame stands upright at 0.
/// \param p_base_tip  of the tip link at 0, m.
/// \param limit       of every joint, both ways, joint units.
inline kinematics::Chain screw_arm(const std::vector<Line>& lines, const Eigen::Vector3d& p_base_tip,
                                   double limit = std::numbers::pi) {
  kinematics::ChainParts parts;
  parts.base_link = "base";
  parts.tip_link = "tip";
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (const Line& line : lines) {
    kinematics::Joint joint;
    joint.name = "joint" + std::to_string(parts.joints.size() + 1);
    joint.type = line.type;
    joint.T_previous_joint.translation() = line.point - last;
    joint.axis = line.direction.normalized();
    joint.lower = -limit;
    joint.upper = limit;
    parts.joints.push_back(joint);
    last = line.point;
  }
  parts.T_last_tip.translation() = p_base_tip - last;
  return kinematics::Chain(std::move(parts));
}

}  // namespace kinship::test
