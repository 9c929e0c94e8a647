#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string_view>

#include "proto/types/result.hpp"

namespace kinship::geometry {

inline constexpr std::size_t kMaxCloudBytes = 256'000'000;
inline constexpr std::size_t kMaxPoints = 20'000'000;  ///< of a file

/// What a file says is taken.
struct FilePoints {
  Eigen::Matrix3Xd points;  ///< 3 x n, m, finite
  /// Edge of the cubes of a map whose corners the points are, m: a grid of cubes as large or larger
  /// leaves out nothing of them. 0: points that a sensor saw.
  double cube_m = 0;
};

/// The points of a file, without those that are not finite.
/// \param ending  "xyz" or "txt": a point a line, three numbers between blanks or tabs, whatever
///                follows them, and no decimal commas; "pcd": of the Point Cloud Library, ascii or
///                binary; "bt" or "ot": an OctoMap, of which the occupied cubes are taken.
/// \return InvalidInput with the line or the member of the header that is wrong; TooLarge above
///         kMaxPoints.
Result<FilePoints> read_points(std::string_view file, std::string_view ending);

}  // namespace kinship::geometry
