#include "server/transfer/arm_shape.hpp"

#include <vector>

#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::transfer {
namespace {

/// Corners of the line along the arm.
Eigen::Matrix3Xd corners(const kinematics::Chain& arm, const Eigen::Ref<const Eigen::VectorXd>& q) {
  const std::vector<Eigen::Isometry3d> T_base_joints = kinematics::joint_poses(arm, q);
  Eigen::Matrix3Xd points(3, arm.dof() + 1);
  for (Eigen::Index j = 0; j < arm.dof(); ++j)
    points.col(j) = T_base_joints[static_cast<std::size_t>(j)].translation();
  points.col(arm.dof()) =
      T_base_joints.back() * (arm.T_last_tip() * arm.T_tip_transfer().translation());
  return points;
}

}  // namespace

ArmShape arm_shape(const kinematics::Chain& arm, const Eigen::Ref<const Eigen::VectorXd>& q) {
  const Eigen::Matrix3Xd points = corners(arm, q);
  const Eigen::Index last = points.cols() - 1;
  const Eigen::VectorXd lengths =
      (points.rightCols(last) - points.leftCols(last)).colwise().norm().transpose();
  const double total = lengths.sum();
  ArmShape shape;
  Eigen::Index segment = 0;
  double before = 0;  // length up to the segment
  for (std::size_t i = 0; i < kShapeShares.size(); ++i) {
    const double at = kShapeShares[i] * total;
    while (segment + 1 < last && before + lengths[segment] < at)
      before += lengths[segment++];
    const double within = lengths[segment] > 0 ? (at - before) / lengths[segment] : 0;
    shape.col(static_cast<Eigen::Index>(i)) =
        points.col(segment) + within * (points.col(segment + 1) - points.col(segment));
  }
  return shape;
}

ArmShape moved(const Eigen::Isometry3d& T_a_b, const ArmShape& shape_in_b) {
  return (T_a_b.linear() * shape_in_b).colwise() + T_a_b.translation();
}

}  // namespace kinship::transfer
