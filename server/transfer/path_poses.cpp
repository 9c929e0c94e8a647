#include "server/transfer/path_poses.hpp"

#include <cstddef>
#include <vector>

#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::transfer {

PathPoses path_poses(const Eigen::MatrixXd& waypoints, const ArmPair& pair,
                     const Eigen::Isometry3d& T_target_source) {
  PathPoses poses;
  const Eigen::Index count = waypoints.cols();
  poses.T_base_transfer.reserve(static_cast<std::size_t>(count));
  poses.source_shapes.reserve(static_cast<std::size_t>(count));
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::vector<Eigen::Isometry3d> T_base_joints =
        kinematics::joint_poses(pair.source(), waypoints.col(i));
    poses.T_base_transfer.push_back(T_target_source *
                                    kinematics::T_base_transfer(pair.source(), T_base_joints));
    poses.source_shapes.push_back(moved(T_target_source, arm_shape(pair.source(), T_base_joints)));
  }
  poses.source_motion =
      (waypoints.rightCols(count - 1) - waypoints.leftCols(count - 1)).colwise().norm().transpose();
  return poses;
}

}  // namespace kinship::transfer
