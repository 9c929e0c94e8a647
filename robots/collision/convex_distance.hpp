#pragma once

#include <Eigen/Geometry>
#include <limits>

#include "proto/types/scene.hpp"

namespace kinship::collision {

/// Lower bound on the distance of two shapes: never more than the true distance, and at most 1 % or
/// 1e-6 m less; 0 where they touch.
///
/// The bound comes from a plane between the shapes, so it holds wherever the iteration ends. FCL's
/// distance is an upper bound, between two points that it found: it proves nothing.
/// \param T_base_a, T_base_b  poses of the shapes' centres in one frame, m
/// \param enough_m            a bound that reaches this need not be tighter
/// Source: Gilbert, Johnson and Keerthi, A fast procedure for computing the distance between
/// complex objects in three-dimensional space, IEEE J. Robotics and Automation (1988), theorem 2;
/// simplices as in Ericson, Real-Time Collision Detection (2005), 5.1.
double convex_distance_m(const Shape& a, const Eigen::Isometry3d& T_base_a, const Shape& b,
                         const Eigen::Isometry3d& T_base_b,
                         double enough_m = std::numeric_limits<double>::infinity());

}  // namespace kinship::collision
