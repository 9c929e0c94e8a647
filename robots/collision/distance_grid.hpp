#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "robots/collision/lanes.hpp"

namespace kinship::collision {

/// How far the space around the cubes of a point cloud is free, as lower bounds for the middles of
/// cells: a sphere is looked up at once, however many cubes there are. Told up to kWindow cells.
class DistanceGrid {
 public:
  static constexpr int kWindow = 8;

  DistanceGrid() = default;  ///< of no cube
  /// \param cubes         in the grid's frame, with corners at multiples of `cube_m`, m
  /// \param cube_m        edge of the smallest cube: a cell is as large, or, where that makes too
  ///                      many, a multiple
  /// \param T_scene_grid  the grid's frame
  DistanceGrid(const std::vector<Eigen::AlignedBox3d>& cubes, double cube_m,
               const Eigen::Isometry3d& T_scene_grid);

  /// For the kernels, while this lives.
  LaneGrid view() const;

 private:
  using Cells = Eigen::Array3i;

  void choose_cells(double cube_m);
  void mark(const Eigen::AlignedBox3d& cube);
  /// From the marks along x, then the least over a window along another axis.
  void measure_rows();
  void spread(Eigen::Index axis);
  std::size_t index(const Cells& cell) const;

  Eigen::Isometry3d T_grid_scene_ = Eigen::Isometry3d::Identity();
  Eigen::AlignedBox3d all_;                           // the box that holds all cubes
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();  // corner of the first cell
  double cell_m_ = 0;
  bool is_exact_ = false;  // a cell is a cube, or free
  Cells cells_ = Cells::Zero();
  std::vector<float> distances_;  // x fastest; first squares in cells, then m
};

}  // namespace kinship::collision
