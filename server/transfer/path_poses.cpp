#include "server/transfer/path_poses.hpp"

#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::transfer {

PathPoses path_poses(const Eigen::MatrixXd& waypoints, const ArmPair& pair,
                     const Eigen::Isometry3d& T_target_source) {
  PathPoses poses;
  const Eigen::Index count = waypoints.cols();
  for (Eigen::Index i = 0; i < count; ++i) {
    poses.T_base_transfer.push_back(T_target_source *
                                    kinematics::T_base_transfer(pair.source(), waypoints.col(i)));
    poses.source_shapes.push_back(
        moved(T_target_source, arm_shape(pair.source(), waypoints.col(i))));
  }
  poses.source_motion =
      (waypoints.rightCols(count - 1) - waypoints.leftCols(count - 1)).colwise().norm().transpose();
  return poses;
}

}  // namespace kinship::transfer
