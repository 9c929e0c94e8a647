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

/// The occupied cubes of an OctoMap file, with (.ot) or without (.bt) probabilities; a cube is
/// occupied from one half on. A corner of a cube lies a millionth of its edge inside it.
///
/// OctoMap's own reader recurses as deep as a damaged file says, and takes missing parts for free.
/// \throws Failure(InvalidInput) if it is no OctoMap, of another kind than OcTree, truncated,
///         longer than its tree or deeper than 16 levels; Failure(TooLarge) above a million cubes.
/// Source: Hornung et al., OctoMap (2013), section 3.5; octomap 1.9, OcTreeBaseImpl::readData and
/// OccupancyOcTreeBase::readBinaryNode.
FilePoints read_octomap(std::string_view file);

}  // namespace kinship::geometry
