#pragma once

#include <Eigen/Core>
#include <vector>

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

struct CoverOptions {
  int max_shapes = 8;      ///< around one mesh
  double min_gain = 0.02;  ///< a cut must lower the volume of all shapes together by this part
};

/// Shapes that together hold every point of a mesh's triangles, so that a body that touches the
/// mesh touches one of them: planes cut the mesh where that lowers the volume most, and a solid is
/// fitted tightly around each piece. Equal input, equal shapes.
/// \param corners  3 x 3 n, m, finite, three columns per triangle, n >= 1.
std::vector<FittedShape> cover_mesh(const Eigen::Matrix3Xd& corners,
                                    const CoverOptions& options = {});

/// Solids that are farther away than this from a mesh that they hold, m: more than rounding moves a
/// vertex.
inline constexpr double kCoverMargin_m = 5e-4;

/// The shape, larger on every side.
Shape grown(const Shape& shape, double by_m);

/// Whether solids, each grown by kCoverMargin_m, together hold every point of triangles. Solids of
/// cover_mesh() do. A mesh that takes more tests than there are left is not held.
/// \param solids      in the frame of the corners.
/// \param corners     3 x 3 n, m, finite, three columns per triangle.
/// \param tests_left  how often a point may be looked for in a solid, some 5 ns each; counted down.
bool hold(const std::vector<FittedShape>& solids, const Eigen::Matrix3Xd& corners,
          std::size_t& tests_left);

}  // namespace kinship::geometry
