#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "robots/kinematics/chain.hpp"

namespace kinship::kinematics {

/// Pose of the tip link in the base link, m.
/// \param q  dof, joint units; limits are not checked.
/// \throws std::invalid_argument if q.size() != chain.dof().
Eigen::Isometry3d T_base_tip(const Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& q);

/// Pose of the transfer frame in the base link.
Eigen::Isometry3d T_base_transfer(const Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& q);
/// \param T_base_joints  joint_poses of the configuration.
Eigen::Isometry3d T_base_transfer(const Chain& chain,
                                  std::span<const Eigen::Isometry3d> T_base_joints);

/// Pose of each moving joint's moving frame in the base link: joints of the chain, from base to
/// tip, then mimic joints.
std::vector<Eigen::Isometry3d> joint_poses(const Chain& chain,
                                           const Eigen::Ref<const Eigen::VectorXd>& q);

/// The same into an existing vector, so that repeated calls allocate nothing.
void joint_poses(const Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& q,
                 std::vector<Eigen::Isometry3d>& poses);

/// Pose of every link in the base link, in the order of chain.links().
std::vector<Eigen::Isometry3d> link_poses(const Chain& chain,
                                          const Eigen::Ref<const Eigen::VectorXd>& q);

using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Geometric Jacobian of the tip link in the base link: 6 x dof, rows 0-2 linear velocity of the
/// tip's origin (m per joint unit), rows 3-5 angular velocity (rad per joint unit).
/// Source: Siciliano et al., Robotics (2009), eq. 3.30.
Jacobian J_base_tip(const Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& q);

}  // namespace kinship::kinematics
