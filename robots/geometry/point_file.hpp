#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string_view>

#include "proto/types/result.hpp"

namespace kinship::geometry {

inline constexpr std::size_t kMaxCloudBytes = 256'000'000;
inline constexpr std::size_t kMaxPoints = 20'000'000;  ///< of a file

/// The points of a file.
struct FilePoints {
  Eigen::Matrix3Xd points;  ///< 3 x n, m, finite
  /// Edge of the cubes of a map whose corners the points are, m: a grid of cubes as large or larger
  /// leaves out none of them. 0: points of a sensor.
  double cube_m = 0;
};

/// The finite points of a file.
/// \param ending  "xyz" or "txt": one point per line, three numbers between blanks or tabs, without
///                decimal commas; more words on the line are ignored; "pcd": of the Point Cloud
///                Library, ascii or binary; "bt" or "ot": an OctoMap, for its occupied cubes.
/// \return InvalidInput with the wrong line or member of the header; TooLarge above kMaxPoints.
Result<FilePoints> read_points(std::string_view file, std::string_view ending);

}  // namespace kinship::geometry
