#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string_view>

#include "proto/types/result.hpp"

namespace kinship::geometry {

inline constexpr std::size_t kMaxMeshBytes = 64'000'000;
inline constexpr std::size_t kMaxMeshTriangles = 2'000'000;

/// The corners of the triangles of a mesh, in its own frame: 3 x 3 n, m, three columns per
/// triangle; a face with more corners is a fan of triangles.
///
/// The unit of a DAE file is applied; its up-axis is not: x, y and z are taken as written, as in
/// other readers of URDF.
/// \param bytes   contents of a file, untrusted.
/// \param format  the file's ending: stl (binary or text), obj or dae, in either case.
/// \return        InvalidInput for another format, and for a file that is unreadable, without
///                triangles or with numbers that are not finite; TooLarge above kMaxMeshBytes or
///                kMaxMeshTriangles.
Result<Eigen::Matrix3Xd> read_mesh(std::string_view bytes, std::string_view format);

}  // namespace kinship::geometry
