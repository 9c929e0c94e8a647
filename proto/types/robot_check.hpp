#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/field.hpp"

/// What the command line finds out about a robot without a server.
namespace kinship {

struct CheckedJoint {
  std::string name;
  std::string type;  ///< revolute, continuous, prismatic
  double lower = 0;  ///< joint units
  double upper = 0;
};

template <>
inline constexpr std::tuple kFieldsOf<CheckedJoint>{
    Field{"name", &CheckedJoint::name}, Field{"type", &CheckedJoint::type},
    Field{"lower", &CheckedJoint::lower}, Field{"upper", &CheckedJoint::upper}};

/// `robots check`.
struct RobotCheck {
  Digest robot;
  std::string base_link, tip_link;
  std::vector<CheckedJoint> joints;
  std::string structure;  ///< of the axes, and what closed form it allows, in words
  std::string solver;
  std::uint64_t poses = 0;  ///< reachable ones that were solved
  std::uint64_t poses_without_solution = 0;
  double solutions_per_pose = 0;
  double time_per_pose_us = 0;  ///< CPU time
};

/// `robots ik`.
struct InverseAnswer {
  std::string solver;
  Eigen::MatrixXd solutions;  ///< dof x n
  std::string reason;         ///< out_of_reach, limits, not_converged; empty if n > 0
  double time_us = 0;         ///< CPU time
};

}  // namespace kinship
