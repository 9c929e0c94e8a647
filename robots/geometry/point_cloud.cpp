#include "robots/geometry/point_cloud.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <queue>
#include <utility>

namespace kinship::geometry {
namespace {

constexpr double kMaxCellsAcross = 65'000;  // OctoMap's keys have 16 bits

/// The box of cubes, as a block.
VoxelBlock block_of(Eigen::Matrix3Xd voxels, double voxel_m) {
  const Eigen::Array3d low = voxels.rowwise().minCoeff().array() - voxel_m / 2;
  const Eigen::Array3d high = voxels.rowwise().maxCoeff().array() + voxel_m / 2;
  VoxelBlock block{std::move(voxels)};
  block.center = ((low + high) / 2 / voxel_m - 0.25).round() * voxel_m;  // the lower of two
  const Eigen::Array3d center = block.center;
  block.size = 2 * (high - center).max(center - low);
  return block;
}

}  // namespace

Result<Eigen::Matrix3Xd> voxels_of(const Eigen::Matrix3Xd& points, double voxel_m) {
  constexpr double kFarthest_m = 1000;
  if (points.cols() == 0)
    return Error{ErrorCode::InvalidInput, "holds no point"};
  if (const double farthest = points.cwiseAbs().maxCoeff(); farthest > kFarthest_m)
    return Error{ErrorCode::InvalidInput, "a coordinate of " + std::to_string(farthest) +
                                              " m, at most 1000 m are allowed: are these metres?"};
  std::vector<std::array<std::int32_t, 3>> cells;
  cells.reserve(static_cast<std::size_t>(points.cols()));
  for (const auto& point : points.colwise()) {
    const Eigen::Array3d cell = (point / voxel_m).array().floor();
    cells.push_back({static_cast<std::int32_t>(cell[0]), static_cast<std::int32_t>(cell[1]),
                     static_cast<std::int32_t>(cell[2])});
  }
  const Eigen::Array3d span =
      (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).array() / voxel_m;
  if (span.maxCoeff() > kMaxCellsAcross)
    return Error{ErrorCode::InvalidInput,
                 "spans " + std::to_string(span.maxCoeff() * voxel_m) + " m, at most " +
                     std::to_string(kMaxCellsAcross * voxel_m) + " m are allowed with voxels of " +
                     std::to_string(voxel_m) +
                     " m: leave out points far away, or give a larger voxel"};
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  if (cells.size() > kMaxVoxels)
    return Error{ErrorCode::TooLarge, std::to_string(cells.size()) + " voxels of " +
                                          std::to_string(voxel_m) + " m, at most " +
                                          std::to_string(kMaxVoxels) +
                                          " are allowed: give a larger voxel"};
  Eigen::Matrix3Xd voxels(3, static_cast<Eigen::Index>(cells.size()));
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      voxels(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i)) =
          (cells[i][axis] + 0.5) * voxel_m;
  return voxels;
}

std::vector<VoxelBlock> blocks_of(const Eigen::Matrix3Xd& voxels, double voxel_m,
                                  std::size_t most) {
  const auto is_shorter = [](const VoxelBlock& a, const VoxelBlock& b) {
    return std::pair(a.voxels.cols() > 1, a.size.maxCoeff()) <
           std::pair(b.voxels.cols() > 1, b.size.maxCoeff());
  };
  std::priority_queue<VoxelBlock, std::vector<VoxelBlock>, decltype(is_shorter)> blocks(is_shorter);
  blocks.push(block_of(voxels, voxel_m));
  while (blocks.size() < most && blocks.top().voxels.cols() > 1) {
    const VoxelBlock block = blocks.top();
    blocks.pop();
    Eigen::Index axis = 0;
    (block.voxels.rowwise().maxCoeff() - block.voxels.rowwise().minCoeff()).maxCoeff(&axis);
    std::vector<Eigen::Index> order(static_cast<std::size_t>(block.voxels.cols()));
    for (std::size_t i = 0; i < order.size(); ++i)
      order[i] = static_cast<Eigen::Index>(i);
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
    std::nth_element(order.begin(), middle, order.end(), [&](Eigen::Index a, Eigen::Index b) {
      return std::pair(block.voxels(axis, a), a) < std::pair(block.voxels(axis, b), b);
    });
    blocks.push(block_of(block.voxels(Eigen::all, std::vector(order.begin(), middle)), voxel_m));
    blocks.push(block_of(block.voxels(Eigen::all, std::vector(middle, order.end())), voxel_m));
  }
  std::vector<VoxelBlock> all;
  for (; !blocks.empty(); blocks.pop())
    all.push_back(blocks.top());
  return all;
}

}  // namespace kinship::geometry
