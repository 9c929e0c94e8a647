#include "robots/collision/distance_grid.hpp"

#include <algorithm>
#include <cmath>

namespace kinship::collision {
namespace {

constexpr double kMostCells = 2'500'000;
constexpr double kRounding = 1e-3;  // of a corner's place, cells
constexpr float kFar = (DistanceGrid::kWindow - 0.5F) * (DistanceGrid::kWindow - 0.5F);

/// The squared distance of a cell's centre from another cell along one axis, in cells.
float squared_gap(int cells) {
  const float gap = std::max(static_cast<float>(std::abs(cells)) - 0.5F, 0.0F);
  return std::min(gap * gap, kFar);
}

}  // namespace

DistanceGrid::DistanceGrid(const std::vector<Eigen::AlignedBox3d>& cubes, double cube_m,
                           const Eigen::Isometry3d& T_scene_grid)
    : T_grid_scene_(T_scene_grid.inverse(Eigen::Isometry)) {
  for (const Eigen::AlignedBox3d& cube : cubes)
    all_.extend(cube);
  if (all_.isEmpty())
    return;
  choose_cells(cube_m);
  distances_.assign(static_cast<std::size_t>(cells_.prod()), kFar);
  for (const Eigen::AlignedBox3d& cube : cubes)
    mark(cube);
  measure_rows();
  spread(1);
  spread(2);
  for (float& each : distances_)
    each = std::sqrt(each) * static_cast<float>(cell_m_);
}

void DistanceGrid::choose_cells(double cube_m) {
  Eigen::Array3d low, high;
  for (double cubes_a_side = 1;; ++cubes_a_side) {
    cell_m_ = cubes_a_side * cube_m;
    low = (all_.min().array() / cell_m_ + kRounding).floor() - kWindow;
    high = (all_.max().array() / cell_m_ - kRounding).ceil() + kWindow;
    is_exact_ = cubes_a_side == 1;
    if ((high - low).prod() <= kMostCells)
      break;
  }
  cells_ = (high - low).cast<int>();
  origin_ = cell_m_ * low.matrix();
}

std::size_t DistanceGrid::index(const Cells& cell) const {
  return static_cast<std::size_t>((cell.z() * cells_.y() + cell.y()) * cells_.x() + cell.x());
}

/// 0 in the cells that the cube shares more than a side with.
void DistanceGrid::mark(const Eigen::AlignedBox3d& cube) {
  const Cells low = ((cube.min() - origin_).array() / cell_m_ + kRounding).floor().cast<int>();
  const Cells end = ((cube.max() - origin_).array() / cell_m_ - kRounding).ceil().cast<int>();
  for (int z = low.z(); z < end.z(); ++z)
    for (int y = low.y(); y < end.y(); ++y)
      std::fill_n(distances_.begin() + static_cast<std::ptrdiff_t>(index({low.x(), y, z})),
                  end.x() - low.x(), 0.0F);
}

void DistanceGrid::measure_rows() {
  const int length = cells_.x();
  for (std::size_t first = 0; first < distances_.size();
       first += static_cast<std::size_t>(length)) {
    float* const row = distances_.data() + first;
    int since = kWindow;
    const auto look = [&](int x) {
      since = row[x] == 0 ? 0 : std::min(since + 1, kWindow);
      row[x] = std::min(row[x], squared_gap(since));
    };
    for (int x = 0; x < length; ++x)
      look(x);
    since = kWindow;
    for (int x = length; x-- > 0;)
      look(x);
  }
}

void DistanceGrid::spread(Eigen::Index axis) {
  const auto stride = static_cast<std::size_t>(axis == 1 ? cells_.x() : cells_.x() * cells_.y());
  const auto length = static_cast<std::size_t>(cells_[axis]);
  const std::vector<float> before = distances_;
  for (std::size_t slab = 0; slab < distances_.size(); slab += stride * length)
    for (std::size_t to = 0; to < length; ++to)
      for (int step = -kWindow; step <= kWindow; ++step) {
        const std::size_t from = to + static_cast<std::size_t>(step);
        if (step == 0 || from >= length)
          continue;
        const float gap = squared_gap(step);
        float* const nearest = distances_.data() + slab + to * stride;
        const float* const other = before.data() + slab + from * stride;
        for (std::size_t i = 0; i < stride; ++i)
          nearest[i] = std::min(nearest[i], other[i] + gap);
      }
}

LaneGrid DistanceGrid::view() const {
  LaneGrid grid{};
  if (distances_.empty())
    return grid;
  grid.distances = distances_.data();
  grid.cell = static_cast<float>(cell_m_);
  grid.is_exact = is_exact_;
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index k = 0; k < 3; ++k)
      grid.R[3 * i + k] = static_cast<float>(T_grid_scene_(i, k));
    grid.p[i] = static_cast<float>(T_grid_scene_(i, 3) - origin_[i]);
    grid.cells[i] = cells_[i];
    grid.center[i] = static_cast<float>(all_.center()[i] - origin_[i]);
    grid.half[i] = static_cast<float>(all_.sizes()[i] / 2);
  }
  return grid;
}

}  // namespace kinship::collision
