#include "robots/collision/solid.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "proto/types/failure.hpp"
#include "robots/geometry/shape_rules.hpp"

namespace kinship::collision {
namespace {

constexpr int kMaxCoverSpheres = 4;
constexpr double kSlack_m = 1e-9;  // so that rounding never calls touching solids apart

std::shared_ptr<const fcl::CollisionGeometry<double>> make_geometry(const Shape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape))
    return std::make_shared<fcl::Box<double>>(box->size);
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return std::make_shared<fcl::Cylinder<double>>(cylinder->radius_m, cylinder->length_m);
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return std::make_shared<fcl::Sphere<double>>(sphere->radius_m);
  const auto& capsule = std::get<CapsuleShape>(shape);
  return std::make_shared<fcl::Capsule<double>>(capsule.radius_m, capsule.length_m);
}

std::shared_ptr<const fcl::CollisionGeometry<double>> make_mesh(const Eigen::Matrix3Xd& triangles) {
  if (triangles.cols() == 0 || triangles.cols() % 3 != 0 || !triangles.allFinite())
    throw Failure(ErrorCode::InvalidInput, "mesh: " + std::to_string(triangles.cols()) +
                                               " corners are no triangles, or not finite");
  auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSS<double>>>();
  mesh->beginModel(static_cast<int>(triangles.cols() / 3), static_cast<int>(triangles.cols()));
  for (Eigen::Index i = 0; i < triangles.cols(); i += 3)
    mesh->addTriangle(triangles.col(i), triangles.col(i + 1), triangles.col(i + 2));
  mesh->endModel();
  mesh->computeLocalAABB();
  return mesh;
}

Eigen::Vector3d half_extents(const Shape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape))
    return box->size / 2;
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return {cylinder->radius_m, cylinder->radius_m, cylinder->length_m / 2};
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return Eigen::Vector3d::Constant(sphere->radius_m);
  const auto& capsule = std::get<CapsuleShape>(shape);
  return {capsule.radius_m, capsule.radius_m, capsule.length_m / 2 + capsule.radius_m};
}

/// Radius of the cross-section perpendicular to the longest axis `axis`.
double cross_radius(const Shape& shape, const Eigen::Vector3d& half, Eigen::Index axis) {
  if (std::holds_alternative<BoxShape>(shape) || axis != 2) {
    Eigen::Vector3d cross = half;
    cross[axis] = 0;
    return cross.norm();
  }
  return half.x();  // round about z
}

}  // namespace

Solid::Solid(const Shape& shape, const Eigen::Matrix3Xd* triangles) {
  if (const auto why = geometry::broken_rule(shape))
    throw Failure(ErrorCode::InvalidInput, *why);
  geometry_ = triangles != nullptr ? make_mesh(*triangles) : make_geometry(shape);
  half_extents_m_ = half_extents(shape);
  Eigen::Index axis = 2;
  if (!std::holds_alternative<SphereShape>(shape))
    half_extents_m_.maxCoeff(&axis);
  const double half_length = half_extents_m_[axis];
  const double cross = cross_radius(shape, half_extents_m_, axis);
  const bool round_ends =
      std::holds_alternative<SphereShape>(shape) || std::holds_alternative<CapsuleShape>(shape);
  radius_m_ = (round_ends ? half_length : std::hypot(half_length, cross)) + kSlack_m;

  // `count` slices along the longest axis, each within one sphere about the slice's centre.
  const int count =
      std::clamp(static_cast<int>(std::ceil(half_length / cross)), 1, kMaxCoverSpheres);
  cover_radius_m_ = count == 1 ? radius_m_ : std::hypot(half_length / count, cross) + kSlack_m;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    center[axis] = half_length * ((2 * i + 1.0) / count - 1);
    cover_centers_m_.push_back(center);
  }
}

bool Solid::cover_misses_box_of(const Solid& other, const Eigen::Isometry3d& T_other_this) const {
  const double limit = cover_radius_m_ * cover_radius_m_;
  return std::all_of(
      cover_centers_m_.begin(), cover_centers_m_.end(), [&](const Eigen::Vector3d& center) {
        const Eigen::Vector3d p = T_other_this * center;
        return (p.cwiseAbs() - other.half_extents_m_).cwiseMax(0).squaredNorm() > limit;
      });
}

bool touch(const Solid& a, const Eigen::Isometry3d& T_base_a, const Solid& b,
           const Eigen::Isometry3d& T_base_b) {
  const double reach = a.radius_m_ + b.radius_m_;
  if ((T_base_a.translation() - T_base_b.translation()).squaredNorm() > reach * reach)
    return false;
  const Eigen::Isometry3d T_a_b = T_base_a.inverse(Eigen::Isometry) * T_base_b;
  if (b.cover_misses_box_of(a, T_a_b))
    return false;
  if (a.cover_misses_box_of(b, T_a_b.inverse(Eigen::Isometry)))
    return false;

  static const fcl::CollisionRequest<double> kRequest = [] {
    fcl::CollisionRequest<double> request(1, /*enable_contact_=*/false);
    request.gjk_solver_type = fcl::GST_LIBCCD;
    return request;
  }();
  fcl::CollisionResult<double> result;
  return fcl::collide(a.geometry_.get(), T_base_a, b.geometry_.get(), T_base_b, kRequest, result) >
         0;
}

}  // namespace kinship::collision
