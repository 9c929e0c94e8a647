#pragma once

#include <Eigen/Core>
#include <string_view>

#include "proto/types/result.hpp"

namespace kinship::geometry {

/// The corners of the triangles of an STL file: 3 x 3 n, three columns per triangle, as in the
/// file, in single precision.
///
/// A file is binary if its length fits the number of facets that it announces, whatever its first
/// 80 bytes are, or if it has no word of the text form. Up to 49 bytes may follow the facets, or
/// any number of zeros. In text, keywords count in either case, and several solids are one mesh.
/// \return InvalidInput with the line or the number of facets for a file that is neither, is
///         truncated, or holds more than it announces; TooLarge above kMaxMeshTriangles.
Result<Eigen::Matrix3Xd> read_stl(std::string_view bytes);

}  // namespace kinship::geometry
