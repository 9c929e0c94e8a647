#pragma once

#include <Eigen/Core>
#include <vector>

#include "robots/geometry/fitted_shape.hpp"

namespace kinship::geometry {

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

}  // namespace kinship::geometry
