#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robots/kinematics/chain.hpp"

namespace kinship::experiments {

/// Positions of the transfer frame and its approach directions, in the task frame.
struct Poses {
  Eigen::Matrix3Xd positions;   ///< m
  Eigen::Matrix3Xd directions;  ///< unit vectors
};

/// \param configurations  dof x n.
Poses poses_of(const kinematics::Chain& chain, const Eigen::Isometry3d& T_task_base,
               const Eigen::MatrixXd& configurations);

}  // namespace kinship::experiments
