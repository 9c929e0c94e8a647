#include "robots/inverse/axis.hpp"

#include <algorithm>

namespace kinship::inverse {
namespace {

constexpr double kSmallest_m = 1e-9;  // less is rounding
constexpr double kParallel = 1e-6;    // sine between lines that count as parallel here

/// The largest distance between the lines of two joints, or from one to the transfer frame: the
/// size of the arm, wherever it stands and wherever on their lines the joints have their origins.
double size_of(const std::vector<Axis>& axes, const Eigen::Vector3d& p_base_transfer) {
  double size = 0;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i].prismatic)
      continue;
    size = std::max(size, (p_base_transfer - axes[i].foot_of(p_base_transfer)).norm());
    for (std::size_t j = i + 1; j < axes.size(); ++j)
      if (!axes[j].prismatic)
        size = std::max(size, distance_between(axes[i], axes[j]));
  }
  return size > kSmallest_m ? size : 1;
}

}  // namespace

double distance_between(const Axis& a, const Axis& b) {
  const Eigen::Vector3d between = b.point - a.point;
  const Eigen::Vector3d normal = a.direction.cross(b.direction);
  const double sine = normal.norm();
  if (sine < kParallel)
    return (b.point - a.foot_of(b.point)).norm();
  return std::abs(normal.dot(between)) / sine;
}

AxisChain axes_of(const kinematics::Chain& chain) {
  AxisChain result;
  Eigen::Isometry3d T_base_frame = Eigen::Isometry3d::Identity();
  for (const kinematics::Joint& joint : chain.joints()) {
    kinematics::follow(joint.T_previous_joint, T_base_frame);
    result.axes.push_back({(T_base_frame.linear() * joint.axis).normalized(),
                           T_base_frame.translation(),
                           joint.type == kinematics::JointType::Prismatic});
  }
  const Eigen::Isometry3d T = T_base_frame * chain.T_last_tip() * chain.T_tip_transfer();
  result.T_base_transfer = {T.linear(), T.translation()};
  result.scale_m = size_of(result.axes, T.translation());
  for (Axis& axis : result.axes)
    axis.point /= result.scale_m;
  result.T_base_transfer.p /= result.scale_m;
  return result;
}

}  // namespace kinship::inverse
