#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "server/transfer/arm_pair.hpp"
#include "server/transfer/arm_shape.hpp"

namespace kinship::transfer {

/// A resampled path of a source robot in the frame of its target: n poses, and the shapes and
/// motion of the source there.
struct PathPoses {
  std::vector<Eigen::Isometry3d> T_base_transfer;  ///< n, in the target's base link
  std::vector<ArmShape> source_shapes;             ///< n, in the target's base link
  Eigen::VectorXd source_motion;                   ///< n - 1, between neighbours, joint units

  Eigen::Index size() const noexcept { return static_cast<Eigen::Index>(T_base_transfer.size()); }
};

/// \param waypoints        dof x n, n >= 1, of the pair's source.
/// \param T_target_source  pose of the source's base in the target's base.
PathPoses path_poses(const Eigen::MatrixXd& waypoints, const ArmPair& pair,
                     const Eigen::Isometry3d& T_target_source);

}  // namespace kinship::transfer
