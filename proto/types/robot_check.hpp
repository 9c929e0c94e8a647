#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/field.hpp"

/// Answers of the command line about a robot, without a server.
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

/// Collision geometry of a link.
struct CheckedLink {
  std::string link;
  std::uint64_t solids = 0;
  double size_x_m = 0, size_y_m = 0, size_z_m = 0;  ///< of the box along the link's axes
  std::string from;  ///< collision, visual, none, or none (visual only)
};

template <>
inline constexpr std::tuple kFieldsOf<CheckedLink>{
    Field{"link", &CheckedLink::link},         Field{"solids", &CheckedLink::solids},
    Field{"size_x_m", &CheckedLink::size_x_m}, Field{"size_y_m", &CheckedLink::size_y_m},
    Field{"size_z_m", &CheckedLink::size_z_m}, Field{"from", &CheckedLink::from}};

/// `robots check`.
struct RobotCheck {
  Digest robot;
  std::string base_link, tip_link;
  std::vector<CheckedJoint> joints;
  std::string structure;  ///< of the axes, and the closed form it allows, as text
  std::string solver;
  std::uint64_t poses = 0;  ///< reachable ones that were tried
  std::uint64_t poses_without_solution = 0;
  double solutions_per_pose = 0;
  double time_per_pose_us = 0;          ///< CPU time
  double reach_m = 0;                   ///< of the tip link from the base link, stretched out
  double transfer_distance_m = 0;       ///< of the transfer frame from the tip link
  std::vector<CheckedLink> links = {};  ///< empty if the geometry is not known here
};

/// `robots ik`.
struct InverseAnswer {
  std::string solver;
  Eigen::MatrixXd solutions;  ///< dof x n
  std::string reason;         ///< out_of_reach, limits, not_converged, colliding; empty if n > 0
  double time_us = 0;         ///< CPU time
  std::optional<std::uint64_t> colliding;  ///< left out for collision; missing: not checked
};

/// `robots fk`: poses of a robot at a configuration, in the base link or in the task frame.
struct ForwardAnswer {
  Eigen::VectorXd q;  ///< dof, joint units
  bool is_in_task = false;
  Eigen::Isometry3d tip = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d transfer = Eigen::Isometry3d::Identity();
};

}  // namespace kinship
