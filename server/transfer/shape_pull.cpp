#include "server/transfer/shape_pull.hpp"

#include <Eigen/Cholesky>
#include <cstddef>

namespace kinship::transfer {
namespace {

constexpr double kPoseWeight = 10;    // of the pose against the shape
constexpr double kDamping = 0.02;     // m per joint unit
constexpr double kLargestStep = 0.3;  // of one joint, joint units
constexpr double kMinPull = 1e-3;     // share of the distance that a step has to take away
constexpr int kPullIterations = 15;

/// The step that would close the distance if shape and pose were linear in the joints, damped.
inverse::JointVector step_towards(const ArmShape& wanted, const TaskAxes& axes,
                                  const ArmShapeMotion& motion) {
  const Eigen::Index dof = motion.J_pose.cols();
  using System =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, int{kMaxDof}, int{kMaxDof}>;
  System system = motion.J_points.transpose() * motion.J_points;
  system.diagonal().array() += kDamping * kDamping;
  for (Eigen::Index row = 0; row < motion.J_pose.rows(); ++row)
    if (axes.matters[static_cast<std::size_t>(row)])
      system +=
          kPoseWeight * kPoseWeight * motion.J_pose.row(row).transpose() * motion.J_pose.row(row);
  const inverse::JointVector pull =
      motion.J_points.transpose() * (wanted - motion.shape).reshaped();
  const inverse::JointVector step = system.llt().solve(pull);
  return step.cwiseMin(inverse::JointVector::Constant(dof, kLargestStep))
      .cwiseMax(inverse::JointVector::Constant(dof, -kLargestStep));
}

}  // namespace

double pull_alone(const ArmPair& pair, const Eigen::Isometry3d& T_base_transfer,
                  const ArmShape& wanted, int steps, inverse::JointVector& q) {
  const kinematics::Chain& arm = pair.target();
  ArmShapeMotion motion = arm_shape_motion(arm, q);
  double distance = shape_distance(motion.shape, wanted);
  for (int i = 0; i < steps; ++i) {
    inverse::JointVector next = q + step_towards(wanted, arm.task_axes(), motion);
    const double squared = pair.target_descent().run(
        T_base_transfer, inverse::Descent::Limits::Hold, kPullIterations, next);
    if (!(squared <= inverse::kPoseTolerance * inverse::kPoseTolerance))
      break;
    motion = arm_shape_motion(arm, next);
    const double reached = shape_distance(motion.shape, wanted);
    if (!(reached < distance))
      break;
    const bool goes_on = reached <= distance * (1 - kMinPull);
    q = next;
    distance = reached;
    if (!goes_on)
      break;
  }
  return distance;
}

}  // namespace kinship::transfer
