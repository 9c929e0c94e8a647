#include "robots/collision/motion_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kinship::collision {
namespace {

constexpr double kReachRounding = 1e-9;

/// Corners of a line along z.
Eigen::Matrix3Xd ends_of(double length_m) {
  Eigen::Matrix3Xd ends = Eigen::Matrix3Xd::Zero(3, 2);
  ends.row(2) << -length_m / 2, length_m / 2;
  return ends;
}

Eigen::Matrix3Xd corners_of(const Eigen::Vector3d& half) {
  Eigen::Matrix3Xd corners(3, 8);
  for (int i = 0; i < 8; ++i)
    corners.col(i) << (i & 1 ? 1 : -1) * half.x(), (i & 2 ? 1 : -1) * half.y(),
        (i & 4 ? 1 : -1) * half.z();
  return corners;
}

struct Spanned {
  Eigen::Matrix3Xd corners;
  double radius_m = 0;
};

Spanned span_of(const Shape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape))
    return {corners_of(box->size / 2), 0};
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return {ends_of(cylinder->length_m), cylinder->radius_m};
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return {Eigen::Matrix3Xd::Zero(3, 1), sphere->radius_m};
  const auto& capsule = std::get<CapsuleShape>(shape);
  return {ends_of(capsule.length_m), capsule.radius_m};
}

}  // namespace

MotionBounds::MotionBounds(const kinematics::Chain& chain, const std::vector<Body>& bodies) {
  for (int j = 0; j < chain.moving_joints(); ++j) {
    const kinematics::Joint& joint = chain.moving_joint(j);
    const Eigen::Vector3d origin = joint.T_previous_joint.translation();
    const int before = chain.joint_before(j);
    steps_.push_back(
        {.axis = joint.axis,
         .slides = joint.type == kinematics::JointType::Prismatic,
         .before = before,
         .source = j,
         .origin_across_m = before < 0 ? 0 : origin.cross(chain.moving_joint(before).axis).norm(),
         .origin_reach_m = origin.norm()});
  }
  auto step = steps_.begin() + chain.dof();
  for (const kinematics::MimicJoint& mimic : chain.mimics()) {
    step->source = mimic.source;
    step->multiplier = mimic.multiplier;
    step->offset = mimic.offset;
    ++step;
  }
  for (const Body& body : bodies) {
    Spanned span = span_of(body.solid.shape());
    Hull hull{body.joint, body.T_joint_body * span.corners, span.radius_m};
    if (body.joint >= 0)
      for (const auto& corner : hull.corners.colwise()) {
        Step& its = steps_[static_cast<std::size_t>(body.joint)];
        const Eigen::Vector3d at = corner;
        its.across_m = std::max(its.across_m, at.cross(its.axis).norm() + span.radius_m);
        its.reach_m = std::max(its.reach_m, at.norm() + span.radius_m);
      }
    hulls_.push_back(std::move(hull));
  }
}

double MotionBounds::farthest_m(const Eigen::Ref<const Eigen::VectorXd>& from,
                                const Eigen::Ref<const Eigen::VectorXd>& to) const {
  double farthest = 0;
  for (int joint = 0; joint < static_cast<int>(steps_.size()); ++joint) {
    const Step& own = steps_[static_cast<std::size_t>(joint)];
    // Of the bodies' points, from the axis and from the origin of the joint that is looked at.
    double across = own.across_m, reach = own.reach_m, motion = 0;
    for (int k = joint; k >= 0;) {
      const Step& step = steps_[static_cast<std::size_t>(k)];
      const double change = std::abs(step.multiplier * (to[step.source] - from[step.source]));
      motion += change * (step.slides ? 1 : across) * (1 + kReachRounding);
      // One joint on: by how far it slides, and by where its origin is.
      const auto slid = [&](double q) { return std::abs(step.multiplier * q + step.offset); };
      const double slide =
          step.slides ? std::max(slid(from[step.source]), slid(to[step.source])) : 0;
      across = step.origin_across_m + slide + reach + kReachRounding;
      reach += step.origin_reach_m + slide + kReachRounding;
      k = step.before;
    }
    // Beyond all numbers, or not a number after that: no bound is known, whatever other joints do.
    if (!std::isfinite(motion))
      return std::numeric_limits<double>::infinity();
    farthest = std::max(farthest, motion);
  }
  return farthest;
}

void MotionBounds::measure(std::size_t body, const std::vector<Eigen::Isometry3d>& T_base_joints,
                           Eigen::Ref<Eigen::VectorXd> reach_m) const {
  const Hull& hull = hulls_[body];
  const Eigen::Isometry3d& T_base_body = T_base_joints[static_cast<std::size_t>(hull.joint)];
  for (int k = hull.joint; k >= 0; k = steps_[static_cast<std::size_t>(k)].before) {
    const auto joint = static_cast<std::size_t>(k);
    reach_m[k] = 0;
    if (steps_[joint].slides)
      continue;
    const Eigen::Vector3d axis = T_base_joints[joint].linear() * steps_[joint].axis;
    const Eigen::Vector3d origin = T_base_joints[joint].translation();
    double farthest2 = 0;
    for (Eigen::Index i = 0; i < hull.corners.cols(); ++i) {
      const Eigen::Vector3d corner = T_base_body * hull.corners.col(i);
      farthest2 = std::max(farthest2, (corner - origin).cross(axis).squaredNorm());
    }
    reach_m[k] = std::sqrt(farthest2) + hull.radius_m + kReachRounding;
  }
}

void MotionBounds::bound(std::size_t body, const Eigen::Ref<const Eigen::VectorXd>& change,
                         const Eigen::Ref<const Eigen::VectorXd>& from_m,
                         const Eigen::Ref<const Eigen::VectorXd>& to_m,
                         Eigen::Ref<Eigen::VectorXd> motion_m) const {
  double motion = 0;
  for (int k = hulls_[body].joint; k >= 0;) {
    const Step& step = steps_[static_cast<std::size_t>(k)];
    motion_m[k + 1] = motion;
    // On the way the body is at most `motion` away from where it is at one end, as the joint's link
    // sees it, so its distance from the axis is at most the mean of both ends' and half of that
    // more.
    const double reach = step.slides ? 1 : (from_m[k] + to_m[k] + motion) / 2;
    motion += std::abs(step.multiplier * change[step.source]) * reach * (1 + kReachRounding);
    k = step.before;
  }
  motion_m[0] = motion;
}

}  // namespace kinship::collision
