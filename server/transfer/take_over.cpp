#include "server/transfer/take_over.hpp"

#include <algorithm>

#include "proto/types/turn.hpp"
#include "robots/inverse/joint_space.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::transfer {
namespace {

using inverse::NoSolution;
using kinematics::JointType;

constexpr int kIterations = 15;

/// Moves `q` to where the target's transfer frame is exactly where the source's was.
/// \return whether it got there and stayed close.
bool polish(const ArmPair& pair, Eigen::VectorXd& q) {
  const Eigen::Isometry3d T_base_transfer = kinematics::T_base_transfer(pair.source(), q);
  inverse::JointVector moved = q;
  pair.target_descent().run(T_base_transfer, inverse::Descent::Limits::Ignore, kIterations, moved);
  if (!((moved - q).norm() <= kFarthestPolish))
    return false;
  q = moved;
  return inverse::reaches(pair.target(), T_base_transfer, q);
}

}  // namespace

bool bring_within(const kinematics::Chain& robot, Eigen::Ref<Eigen::VectorXd> q) {
  for (Eigen::Index j = 0; j < robot.dof(); ++j) {
    const kinematics::Joint& joint = robot.joints()[static_cast<std::size_t>(j)];
    const auto outside = [&joint](double value) {
      return value < joint.lower - inverse::kLimitRounding ||
             value > joint.upper + inverse::kLimitRounding;
    };
    const double middle = 0.5 * (joint.lower + joint.upper);
    if (joint.type == JointType::Continuous)
      q[j] = wrapped(q[j]);
    else if (joint.type == JointType::Revolute && outside(q[j]))
      q[j] = middle + wrapped(q[j] - middle);
    if (outside(q[j]))
      return false;
    q[j] = std::clamp(q[j], joint.lower, joint.upper);
  }
  return true;
}

TransferredPath take_over(const Eigen::MatrixXd& waypoints, const ArmPair& pair) {
  const Eigen::Index count = waypoints.cols();
  const bool exact = pair.likeness() == kinematics::ArmLikeness::Exact;
  TransferredPath result;
  result.configurations.resize(waypoints.rows(), count);
  result.pose_index.resize(count);
  Eigen::Index found = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    Eigen::VectorXd q = waypoints.col(i);
    const NoSolution reason = !exact && !polish(pair, q)        ? NoSolution::NotConverged
                              : !bring_within(pair.target(), q) ? NoSolution::Limits
                                                                : NoSolution::None;
    count_pose(reason == NoSolution::None ? 1 : 0, reason, result.summary);
    if (reason != NoSolution::None)
      continue;
    result.configurations.col(found) = q;
    result.pose_index[found++] = static_cast<int>(i);
  }
  result.configurations.conservativeResize(Eigen::NoChange, found);
  result.pose_index.conservativeResize(found);
  result.solution_index = Eigen::VectorXi::Zero(found);
  result.weights = Eigen::VectorXd::Ones(found);
  return result;
}

}  // namespace kinship::transfer
