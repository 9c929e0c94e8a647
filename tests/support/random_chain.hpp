#pragma once

#include <Eigen/Geometry>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "robots/kinematics/chain.hpp"

namespace kinship::test {

/// What a random chain is made of.
struct RandomChain {
  int joints = 6;
  double length_m = 0.3;            ///< mean distance between joints
  double limit = std::numbers::pi;  ///< of turning joints, both ways
  double sliding_share = 0;         ///< chance of a joint to slide
  double continuous_share = 0;      ///< chance of a turning joint to have no limits
};

/// A vector of length 1, uniform on the sphere.
inline Eigen::Vector3d random_direction(std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  Eigen::Vector3d v;
  do {
    v << normal(generator), normal(generator), normal(generator);
  } while (v.norm() < 1e-3);
  return v.normalized();
}

/// A pose with a uniform orientation, at a distance of half to one and a half of `length_m`.
inline Eigen::Isometry3d random_pose(double length_m, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const double angle_rad = 2 * std::numbers::pi * uniform(generator);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(angle_rad, random_direction(generator)).toRotationMatrix();
  T.translation() = length_m * (0.5 + uniform(generator)) * random_direction(generator);
  return T;
}

/// Joints with random axes and origins: a structure that no closed form knows.
inline kinematics::Chain random_chain(const RandomChain& wanted, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(0, 1);
  kinematics::ChainParts parts;
  parts.base_link = "base";
  parts.tip_link = "tip";
  for (int j = 0; j < wanted.joints; ++j) {
    kinematics::Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.T_previous_joint = random_pose(wanted.length_m, generator);
    joint.axis = random_direction(generator);
    joint.lower = -wanted.limit;
    joint.upper = wanted.limit;
    if (uniform(generator) < wanted.sliding_share) {
      joint.type = kinematics::JointType::Prismatic;
      joint.lower = -wanted.length_m;
      joint.upper = wanted.length_m;
    } else if (uniform(generator) < wanted.continuous_share) {
      joint.type = kinematics::JointType::Continuous;
    }
    parts.joints.push_back(joint);
  }
  parts.T_last_tip = random_pose(wanted.length_m, generator);
  parts.T_tip_transfer = random_pose(0.3 * wanted.length_m, generator);
  return kinematics::Chain(parts);
}

/// Joints beside a chain that follow it: on its base, on its joints and on each other.
inline std::vector<kinematics::MimicJoint> random_mimics(const kinematics::Chain& chain, int count,
                                                         double length_m,
                                                         std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<kinematics::MimicJoint> mimics;
  for (int i = 0; i < count; ++i) {
    kinematics::MimicJoint mimic;
    mimic.joint.name = "mimic" + std::to_string(i);
    mimic.joint.T_previous_joint = random_pose(length_m, generator);
    mimic.joint.axis = random_direction(generator);
    const bool slides = i % 3 == 1;
    mimic.joint.type = slides ? kinematics::JointType::Prismatic : kinematics::JointType::Revolute;
    const auto dof = static_cast<int>(chain.dof());
    mimic.before = std::uniform_int_distribution<int>(-1, dof + i - 1)(generator);
    mimic.source = std::uniform_int_distribution<int>(0, dof - 1)(generator);
    mimic.multiplier = (slides ? 0.1 : 1.5) * uniform(generator);
    mimic.offset = (slides ? 0.1 : 0.5) * uniform(generator);
    mimics.push_back(mimic);
  }
  return mimics;
}

}  // namespace kinship::test
