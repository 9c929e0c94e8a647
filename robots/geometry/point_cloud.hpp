#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "proto/types/result.hpp"

namespace kinship::geometry {

inline constexpr std::size_t kMaxVoxels = 500'000;  ///< of one cloud

/// The middles of the cubes of a grid that hold points, each once, in ascending order; the grid has
/// a corner at the origin.
/// \param points   3 x n, m, finite
/// \param voxel_m  edge of a cube, > 0
/// \return 3 x n, m; InvalidInput if there is no point, one lies farther than a kilometre, or they
///         span more than 65 000 cubes; TooLarge above kMaxVoxels, with advice.
Result<Eigen::Matrix3Xd> voxels_of(const Eigen::Matrix3Xd& points, double voxel_m);

/// Some cubes of a cloud, and a box that holds them.
struct VoxelBlock {
  Eigen::Matrix3Xd voxels;  ///< middles, in the cloud's frame: 3 x n, m
  /// Of the box: a corner of the grid.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
};

/// All cubes in blocks, made by cutting the one with the longest box in the middle, repeatedly.
/// \param voxels  of voxels_of(), n >= 1
/// \param most    blocks, >= 1; fewer for fewer cubes
std::vector<VoxelBlock> blocks_of(const Eigen::Matrix3Xd& voxels, double voxel_m, std::size_t most);

}  // namespace kinship::geometry
