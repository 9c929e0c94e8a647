#include "client/experiments/page/hand_poses.hpp"

#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::experiments {

Poses poses_of(const kinematics::Chain& chain, const Eigen::Isometry3d& T_task_base,
               const Eigen::MatrixXd& configurations) {
  Poses poses{Eigen::Matrix3Xd(3, configurations.cols()),
              Eigen::Matrix3Xd(3, configurations.cols())};
  for (Eigen::Index i = 0; i < configurations.cols(); ++i) {
    const Eigen::Isometry3d T_task_transfer =
        T_task_base * kinematics::T_base_transfer(chain, configurations.col(i));
    poses.positions.col(i) = T_task_transfer.translation();
    poses.directions.col(i) = T_task_transfer.linear().col(2);
  }
  return poses;
}

}  // namespace kinship::experiments
