#include "robots/kinematics/same_arm.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "proto/types/limits.hpp"
#include "proto/types/split_mix.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::kinematics {
namespace {

bool moves_alike(const Joint& a, const Joint& b) {
  return (a.type == JointType::Prismatic) == (b.type == JointType::Prismatic);
}

/// A number in [0, 1) that is fixed by the index of a configuration and of a joint.
double fraction(int configuration, Eigen::Index joint) {
  return unit_interval(
      split_mixed(kSplitMixStep * (static_cast<std::uint64_t>(configuration) * kMaxDof +
                                   static_cast<std::uint64_t>(joint) + 1)));
}

/// The angle by which two orientations differ, also where its cosine rounds to 1.
/// Source: |R_a - R_b| = 2 sqrt(2) |sin(angle / 2)| in the Frobenius norm.
double angle_between(const Eigen::Matrix3d& R_a, const Eigen::Matrix3d& R_b) {
  return 2 * std::asin(std::min(1.0, (R_a - R_b).norm() / (2 * std::numbers::sqrt2)));
}

}  // namespace

ArmLikeness compare_arms(const Chain& a, const Chain& b) {
  if (!std::equal(a.joints().begin(), a.joints().end(), b.joints().begin(), b.joints().end(),
                  moves_alike))
    return ArmLikeness::Different;
  const Eigen::VectorXd lower = a.lower().cwiseMax(b.lower());
  const Eigen::VectorXd range = a.upper().cwiseMin(b.upper()) - lower;
  if (!(range.array() > 0).all())
    return ArmLikeness::Different;
  ArmLikeness likeness = ArmLikeness::Exact;
  Eigen::VectorXd q = lower + range / 2;
  for (int i = 0; i < kArmComparisons; ++i) {
    const Eigen::Isometry3d T_base_a = T_base_transfer(a, q);
    const Eigen::Isometry3d T_base_b = T_base_transfer(b, q);
    const double distance_m = (T_base_a.translation() - T_base_b.translation()).norm();
    const double angle_rad = angle_between(T_base_a.linear(), T_base_b.linear());
    if (!(distance_m <= kNearArm_m && angle_rad <= kNearArm_rad))
      return ArmLikeness::Different;
    if (!(distance_m <= kExactArm && angle_rad <= kExactArm))
      likeness = ArmLikeness::Near;
    for (Eigen::Index j = 0; j < q.size(); ++j)
      q[j] = lower[j] + range[j] * fraction(i, j);
  }
  return likeness;
}

}  // namespace kinship::kinematics
