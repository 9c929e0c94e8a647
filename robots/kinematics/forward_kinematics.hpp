#pragma once

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

}  // namespace kinship::kinematics
