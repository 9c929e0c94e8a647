#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <variant>

#include "proto/types/scene.hpp"
#include "robots/geometry/link_shapes.hpp"

/// Meshes and points on the surfaces of solids: what a vendor's mesh or a camera gives of them.
namespace kinship::bench {

/// From the centre of a shape to its surface in a direction of length 1, m.
struct Radius {
  const Eigen::Vector3d direction;

  double operator()(const BoxShape& box) const {
    return (box.size / 2).cwiseQuotient(direction.cwiseAbs().cwiseMax(1e-12)).minCoeff();
  }
  double operator()(const SphereShape& sphere) const { return sphere.radius_m; }
  double operator()(const CylinderShape& cylinder) const {
    return std::min(cylinder.radius_m / std::max(direction.head<2>().norm(), 1e-12),
                    cylinder.length_m / 2 / std::max(std::abs(direction.z()), 1e-12));
  }
  double operator()(const CapsuleShape& capsule) const {
    const double across = std::max(direction.head<2>().norm(), 1e-12),
                 along = std::abs(direction.z());
    const double half = capsule.length_m / 2, at_side = capsule.radius_m / across;
    if (at_side * along <= half)
      return at_side;
    return half * along +
           std::sqrt(capsule.radius_m * capsule.radius_m - half * half * across * across);
  }
};

/// Triangles whose corners lie on the surface of a shape, some pressed in by up to 4 % of the way
/// to its middle, so that the mesh is no convex one: 3 x 3 n, 4 rings^2 triangles.
inline Eigen::Matrix3Xd surface_mesh(const Shape& shape, int rings) {
  const int columns = 2 * rings;
  const auto corner = [&](int ring, int column) {
    const double polar = M_PI * ring / rings, turn = 2 * M_PI * (column % columns) / columns;
    const Eigen::Vector3d direction(std::sin(polar) * std::cos(turn),
                                    std::sin(polar) * std::sin(turn), std::cos(polar));
    const double dent = 1 - 0.02 * (1 + std::sin(5 * polar) * std::cos(4 * turn));
    return Eigen::Vector3d(dent * std::visit(Radius{direction}, shape) * direction);
  };
  Eigen::Matrix3Xd corners(3, 12 * rings * rings);
  Eigen::Index filled = 0;
  const auto add = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                       const Eigen::Vector3d& c) {
    if ((b - a).cross(c - a).norm() < 1e-14)  // at a pole
      return;
    for (const Eigen::Vector3d& each : {a, b, c})
      corners.col(filled++) = each;
  };
  for (int ring = 0; ring < rings; ++ring)
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector3d a = corner(ring, column), b = corner(ring + 1, column);
      const Eigen::Vector3d c = corner(ring + 1, column + 1), d = corner(ring, column + 1);
      add(a, b, c);
      add(a, c, d);
    }
  return corners.leftCols(filled);
}

/// The robot with a mesh in the place of each solid, which stays the solid around it.
inline geometry::RobotShapes with_meshes(geometry::RobotShapes robot, int rings) {
  for (geometry::LinkShape& each : robot.shapes) {
    each.triangles = std::make_shared<const Eigen::Matrix3Xd>(surface_mesh(each.shape, rings));
    each.approximate = true;
  }
  return robot;
}

/// The obstacles as meshes.
inline Scene as_meshes(const Scene& scene, int rings) {
  Scene result;
  for (const SceneObject& each : scene.objects)
    result.meshes.push_back(
        {each.name,
         {.file = each.name,
          .triangles = std::make_shared<const Eigen::Matrix3Xd>(surface_mesh(each.shape, rings))},
         each.T_task_object});
  return result;
}

/// Points on the obstacles' surfaces, as many on each, in the task frame: 3 x n.
inline Eigen::Matrix3Xd surface_points(const Scene& scene, Eigen::Index count,
                                       std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const SceneObject& object =
        scene.objects.at(static_cast<std::size_t>(i) % scene.objects.size());
    const Eigen::Vector3d direction =
        Eigen::Vector3d::NullaryExpr([&] { return normal(generator); }).normalized();
    points.col(i) =
        object.T_task_object * (std::visit(Radius{direction}, object.shape) * direction);
  }
  return points;
}

/// A map of cubes that hold points.
inline std::shared_ptr<octomap::OcTree> map_of(const Eigen::Matrix3Xd& points, double cube_m) {
  auto map = std::make_shared<octomap::OcTree>(cube_m);
  for (const auto& p : points.colwise())
    map->updateNode(p.x(), p.y(), p.z(), /*occupied=*/true, /*lazy_eval=*/true);
  map->updateInnerOccupancy();
  return map;
}

}  // namespace kinship::bench
