#pragma once

#include <Eigen/Core>
#include <vector>

#include "proto/types/scene.hpp"

namespace kinship::collision {

/// One of the spheres that together hold a solid.
struct CoverSphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< in the solid's frame, m
  double outer_m = 0;                                ///< with the others' it holds all of the solid
  double inner_m = 0;  ///< within it there is nothing but the solid; 0: nothing is known
};

/// Spheres that hold every point of a shape; a thin one needs many to be held closely.
/// \param most  of them, >= 1
std::vector<CoverSphere> cover_shape(const Shape& shape, int most);

/// Spheres that hold every point of triangles. Nothing lies within them for sure.
/// \param triangles  3 x 3 n, m, three columns a triangle, n >= 1
/// \param most       of them, >= 1
std::vector<CoverSphere> cover_triangles(const Eigen::Matrix3Xd& triangles, int most);

}  // namespace kinship::collision
