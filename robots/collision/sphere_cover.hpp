#pragma once

#include <Eigen/Core>
#include <vector>

#include "proto/types/scene.hpp"

namespace kinship::collision {

/// One of the spheres that together hold a solid.
struct CoverSphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< in the solid's frame, m
  double outer_m = 0;  ///< the spheres of these radii hold all of the solid
  double inner_m = 0;  ///< the sphere of this radius is within the solid; 0: unknown
};

/// Spheres that hold every point of a shape; a thin one needs many to be held closely.
/// \param most  of them, >= 1
std::vector<CoverSphere> cover_shape(const Shape& shape, int most);

/// Spheres that hold every point of triangles. Their inner radii are 0.
/// \param triangles  3 x 3 n, m, three columns per triangle, n >= 1
/// \param most       of them, >= 1
std::vector<CoverSphere> cover_triangles(const Eigen::Matrix3Xd& triangles, int most);

}  // namespace kinship::collision
