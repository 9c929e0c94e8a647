#pragma once

#include <Eigen/Geometry>

#include "proto/types/scene.hpp"

namespace kinship::geometry {

/// Smallest extent that a fitted shape gets, m: a flat mesh becomes a plate this thick.
inline constexpr double kMinFitted_m = 1e-3;

/// A solid around points, and where its centre stands in their frame.
struct FittedShape {
  Shape shape;
  Eigen::Isometry3d T_points_shape = Eigen::Isometry3d::Identity();
};

/// A box or capsule that holds every point: of the boxes along the axes of the points' frame and
/// along their principal axes, and the capsules along each of these axes, the one with the smallest
/// volume. Conservative; not the smallest there is.
/// \param points  3 x n, n >= 1, finite, m.
FittedShape fit_shape(const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace kinship::geometry
