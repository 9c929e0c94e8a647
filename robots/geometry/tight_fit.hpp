#pragma once

#include <Eigen/Core>

#include "robots/geometry/fitted_shape.hpp"

namespace kinship::geometry {

double volume_m3(const Shape& shape);

/// A box, cylinder, capsule or sphere that holds every point, smaller than that of fit_shape: along
/// the frame's axes, the principal ones, and both turned step by step while the volume falls; round
/// ones about the middle of the smallest circle. Conservative; not the smallest possible.
/// \param points  3 x n, n >= 1, finite, m.
/// Circles and spheres: Badoiu and Clarkson, Smaller core-sets for balls (2003).
FittedShape fit_tightly(const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// The same without turning, to compare many sets of points.
FittedShape fit_quickly(const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace kinship::geometry
