#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>

#include "proto/types/result.hpp"
#include "proto/types/scene.hpp"

namespace kinship::geometry {

/// Largest extent, radius or length of a shape, m.
inline constexpr double kMaxShape_m = 1000.0;

/// Why a shape is invalid: a size that is not finite, not positive or above kMaxShape_m, with its
/// value. A capsule may have length 0. Empty if the shape is sound.
std::optional<std::string> broken_rule(const Shape& shape);

/// Half the edges of the smallest box in the shape's own frame that holds it, m.
Eigen::Vector3d half_extents_m(const Shape& shape);

/// Smallest extent of a fitted shape, m: a flat mesh becomes a plate this thick.
inline constexpr double kMinFitted_m = 1e-3;

/// A solid around points, and the pose of its centre in their frame.
struct FittedShape {
  Shape shape;
  Eigen::Isometry3d T_points_shape = Eigen::Isometry3d::Identity();
};

/// A box or capsule that holds every point: of the boxes along the axes of the points' frame and
/// along their principal axes, and the capsules along each of these axes, the one with the smallest
/// volume. Conservative; not the smallest possible.
/// \param points  3 x n, n >= 1, finite, m.
FittedShape fit_shape(const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// A mesh in the solid around it.
struct FittedMesh {
  FittedShape fitted;
  /// In the frame of the solid: 3 x 3 n, m, three columns per triangle; never null.
  std::shared_ptr<const Eigen::Matrix3Xd> triangles;
};

/// \param corners  3 x 3 n, m, three columns per triangle.
/// \return         InvalidInput without triangles, for numbers that are not finite, and for a mesh
///                 above the size limit of a shape.
Result<FittedMesh> fit_mesh(const Eigen::Matrix3Xd& corners);

}  // namespace kinship::geometry
