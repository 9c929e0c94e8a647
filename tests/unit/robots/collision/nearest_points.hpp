#pragma once

#include <Eigen/Geometry>
#include <algorithm>

#include "proto/types/scene.hpp"

/// Distance of convex shapes by alternating projections (von Neumann; Cheney and Goldstein 1959):
/// slow, simple, and with nothing in common with GJK, which it is here to check.
namespace kinship::collision::test_support {

/// The point of a shape nearest to p, both in the shape's frame.
struct Projection {
  Eigen::Vector3d p;

  Eigen::Vector3d operator()(const BoxShape& box) const {
    return p.cwiseMax(-box.size / 2).cwiseMin(box.size / 2);
  }
  Eigen::Vector3d operator()(const SphereShape& sphere) const {
    return to_ball(p, sphere.radius_m);
  }
  Eigen::Vector3d operator()(const CylinderShape& cylinder) const {
    Eigen::Vector3d nearest = p;
    const double distance = p.head<2>().norm();
    if (distance > cylinder.radius_m)
      nearest.head<2>() *= cylinder.radius_m / distance;
    nearest.z() = std::clamp(p.z(), -cylinder.length_m / 2, cylinder.length_m / 2);
    return nearest;
  }
  Eigen::Vector3d operator()(const CapsuleShape& capsule) const {
    const Eigen::Vector3d center(0, 0,
                                 std::clamp(p.z(), -capsule.length_m / 2, capsule.length_m / 2));
    return center + to_ball(p - center, capsule.radius_m);
  }

 private:
  static Eigen::Vector3d to_ball(const Eigen::Vector3d& v, double radius) {
    const double norm = v.norm();
    return norm <= radius ? v : Eigen::Vector3d(v * (radius / norm));
  }
};

/// Distance of two shapes, m; below about 1e-6 they touch.
inline double distance_m(const Shape& a, const Eigen::Isometry3d& T_base_a, const Shape& b,
                         const Eigen::Isometry3d& T_base_b) {
  Eigen::Vector3d on_a = T_base_a.translation();
  double distance = 1e9, before = 1e9;
  for (int i = 0; i < 5000 && distance > 1e-9; ++i) {
    const Eigen::Vector3d on_b =
        T_base_b * std::visit(Projection{T_base_b.inverse(Eigen::Isometry) * on_a}, b);
    on_a = T_base_a * std::visit(Projection{T_base_a.inverse(Eigen::Isometry) * on_b}, a);
    distance = (on_a - on_b).norm();
    if (i % 50 != 49)
      continue;
    if (before - distance < 1e-9 * distance)
      break;
    before = distance;
  }
  return distance;
}

}  // namespace kinship::collision::test_support
