#include "proto/types/pose.hpp"

#include <cmath>
#include <string>

#include "proto/types/limits.hpp"
#include "proto/types/number_text.hpp"

namespace kinship {

namespace {

/// Whether the first coordinate that is not about zero is negative.
bool points_backward(const Eigen::Vector3d& axis) {
  constexpr double kAboutZero = 1e-3;
  for (const double coordinate : axis)
    if (std::abs(coordinate) > kAboutZero)
      return coordinate < 0;
  return false;
}

}  // namespace

PoseArray to_pose_array(const Eigen::Isometry3d& T_a_b) {
  const Eigen::Vector3d p = T_a_b.translation();
  Eigen::Quaterniond q(T_a_b.linear());
  q.normalize();
  if (q.w() < 0)
    q.coeffs() = -q.coeffs();
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

Result<Eigen::Isometry3d> from_pose_array(const PoseArray& pose) {
  for (std::size_t i = 0; i < pose.size(); ++i)
    if (!std::isfinite(pose[i]))
      return Error{ErrorCode::InvalidInput,
                   "pose: number " + std::to_string(i + 1) + " of 7 is not finite"};
  for (std::size_t i = 0; i < 3; ++i)
    if (std::abs(pose[i]) > kMaxPlacement_m)
      return Error{ErrorCode::InvalidInput, "pose: coordinate " + number_text(pose[i]) +
                                                " m exceeds " + number_text(kMaxPlacement_m) +
                                                " m; these are probably millimetres"};
  Eigen::Quaterniond q(pose[6], pose[3], pose[4], pose[5]);
  constexpr double kNormTolerance = 1e-3;
  if (std::abs(q.norm() - 1) > kNormTolerance)
    return Error{ErrorCode::InvalidInput,
                 "pose: quaternion (x y z w) has norm " + number_text(q.norm()) + ", must be 1"};
  q.normalize();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = q.toRotationMatrix();
  T.translation() << pose[0], pose[1], pose[2];
  return T;
}

Eigen::Isometry3d snapped(const Eigen::Isometry3d& T_a_b) {
  constexpr double kCell = 1e-3;  // 1 mm and 1 mrad
  const auto snap = [](double value) { return std::round(value / kCell) * kCell; };
  const Eigen::Quaterniond q = [&] {
    const PoseArray pose = to_pose_array(T_a_b);  // qw >= 0: one rotation, one rotation vector
    return Eigen::Quaterniond(pose[6], pose[3], pose[4], pose[5]);
  }();
  const Eigen::AngleAxisd rotation(q);
  Eigen::Vector3d axis = rotation.axis();
  // Half a turn about an axis is half a turn about its opposite: near it, one of both is chosen.
  if (rotation.angle() > EIGEN_PI - 0.5 * kCell && points_backward(axis))
    axis = -axis;
  const Eigen::Vector3d vector = (rotation.angle() * axis).unaryExpr(snap);
  const double angle = vector.norm();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  if (angle > 0)
    T.linear() = Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
  T.translation() = T_a_b.translation().unaryExpr(snap);
  return T;
}

}  // namespace kinship
