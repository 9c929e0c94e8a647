#pragma once

#include <Eigen/Geometry>
#include <random>

#include "robots/kinematics/chain.hpp"

namespace kinship::kinematics {

inline Eigen::Vector3d random_vector(std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  return {normal(generator), normal(generator), normal(generator)};
}

inline Eigen::Isometry3d random_pose(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> angle(-3, 3);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() =
      Eigen::AngleAxisd(angle(generator), random_vector(generator).normalized()).toRotationMatrix();
  T.translation() = random_vector(generator);
  return T;
}

/// Random parts with every type of joint in turn, a link on every joint and one on the base.
inline ChainParts random_parts(int dof, std::mt19937_64& generator) {
  ChainParts parts;
  parts.base_link = "link_0";
  parts.links.push_back({"link_0", -1, Eigen::Isometry3d::Identity(), -1});
  for (int i = 0; i < dof; ++i) {
    Joint joint;
    joint.name = "joint_" + std::to_string(i + 1);
    joint.type = static_cast<JointType>(i % 3);
    joint.T_previous_joint = random_pose(generator);
    joint.axis = random_vector(generator).normalized();
    joint.lower = -1 - i;
    joint.upper = 2 + i;
    parts.joints.push_back(joint);
    parts.links.push_back({"link_" + std::to_string(i + 1), i, random_pose(generator), i});
  }
  parts.tip_link = parts.links.back().name;
  parts.T_last_tip = parts.links.back().T_joint_link;
  parts.T_tip_transfer = random_pose(generator);
  return parts;
}

inline Eigen::VectorXd random_configuration(const Chain& chain, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> unit(0, 1);
  return Eigen::VectorXd::NullaryExpr(chain.dof(), [&](Eigen::Index i) {
    return chain.lower()[i] + unit(generator) * (chain.upper()[i] - chain.lower()[i]);
  });
}

}  // namespace kinship::kinematics
