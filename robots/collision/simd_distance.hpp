// Distances of points from shapes and from a point cloud, in every lane. Included only by the units
// that are compiled for one instruction set.
#pragma once

#include "robots/collision/lanes.hpp"
#include "robots/collision/simd_floats.hpp"
#include "robots/collision/simd_separation.hpp"

namespace kinship::collision {
namespace {

KINSHIP_SIMD_INLINE Wide distance2(const WidePoint& a, const WidePoint& b) {
  const Wide x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return x * x + y * y + z * z;
}

/// Squared distance of a point to a box along the axes.
KINSHIP_SIMD_INLINE Wide distance2_of_box(const float (&center)[3], const float (&half)[3],
                                          const WidePoint& at) {
  const Wide u = positive(absolute(at.x - center[0]) - half[0]);
  const Wide v = positive(absolute(at.y - center[1]) - half[1]);
  const Wide w = positive(absolute(at.z - center[2]) - half[2]);
  return u * u + v * v + w * w;
}

/// Squared distance of a point to a box or cylinder, or to the axis of a capsule.
KINSHIP_SIMD_INLINE Wide distance2(const LaneForm& form, const WidePoint& at) {
  const float(&A)[9] = form.axes;
  if (form.shape == LaneShape::AlignedBox)
    return distance2_of_box(form.center, form.half, at);
  const Wide dx = at.x - form.center[0], dy = at.y - form.center[1], dz = at.z - form.center[2];
  const Wide x = dx * A[0] + dy * A[3] + dz * A[6];
  const Wide y = dx * A[1] + dy * A[4] + dz * A[7];
  const Wide z = positive(absolute(dx * A[2] + dy * A[5] + dz * A[8]) - form.half[2]);
  if (form.shape == LaneShape::Box) {
    const Wide u = positive(absolute(x) - form.half[0]);
    const Wide v = positive(absolute(y) - form.half[1]);
    return u * u + v * v + z * z;
  }
  const Wide across2 = x * x + y * y;
  if (form.shape == LaneShape::Capsule)
    return across2 + z * z;
  const Wide across = positive(root(across2) - form.radius);
  return across * across + z * z;
}

/// Lanes in which a sphere reaches a form.
KINSHIP_SIMD_INLINE unsigned reach(const LaneForm& form, const WidePoint& center, Wide radius) {
  const Wide limit = form.shape == LaneShape::Capsule ? radius + form.radius : radius;
  return below(distance2(form, center), limit * limit);
}

/// Lanes in which a box along the axes overlaps an obstacle's box. \param bounds  of the obstacle
KINSHIP_SIMD_INLINE unsigned overlap(const float* bounds, const WidePoint& center,
                                     const WidePoint& half) {
  return below(all(bounds[0]), center.x + half.x) & below(all(bounds[kLanes]), center.y + half.y) &
         below(all(bounds[2 * kLanes]), center.z + half.z) &
         below(center.x - half.x, all(bounds[3 * kLanes])) &
         below(center.y - half.y, all(bounds[4 * kLanes])) &
         below(center.z - half.z, all(bounds[5 * kLanes]));
}

/// Where points are in the grid, and the lower bound for the middle of their cell.
struct InGrid {
  WidePoint at, from_middle;  ///< m
  Wide distance;              ///< m
};

KINSHIP_SIMD_INLINE InGrid look_up(const LaneGrid& grid, const WidePoint& point) {
  const float(&R)[9] = grid.R;
  InGrid found;
  found.at = {point.x * R[0] + point.y * R[1] + point.z * R[2] + grid.p[0],
              point.x * R[3] + point.y * R[4] + point.z * R[5] + grid.p[1],
              point.x * R[6] + point.y * R[7] + point.z * R[8] + grid.p[2]};
  const float per_cell = 1 / grid.cell;
  const WideInt i = whole(found.at.x * per_cell, grid.cells[0] - 1);
  const WideInt j = whole(found.at.y * per_cell, grid.cells[1] - 1);
  const WideInt k = whole(found.at.z * per_cell, grid.cells[2] - 1);
  found.from_middle = {found.at.x - (rounded(i) + 0.5F) * grid.cell,
                       found.at.y - (rounded(j) + 0.5F) * grid.cell,
                       found.at.z - (rounded(k) + 0.5F) * grid.cell};
  found.distance = gather(grid.distances, (k * grid.cells[1] + j) * grid.cells[0] + i);
  return found;
}

/// Lower bounds on the distance of points from the cloud; below 0: unknown. \param slack  of
/// rounding
KINSHIP_SIMD_INLINE Wide distance_of_cloud(const LaneGrid& grid, const WidePoint& point,
                                           float slack) {
  constexpr float kRounding = 1e-5F;
  const InGrid found = look_up(grid, point);
  const WidePoint& middle = found.from_middle;
  const Wide near = found.distance - root(dot(middle, middle)) * (1 + kRounding);
  const Wide beyond = root(distance2_of_box(grid.center, grid.half, found.at)) * (1 - kRounding);
  return larger(near, beyond) - 4 * slack;
}

/// Lanes in which points are within a cube for sure.
KINSHIP_SIMD_INLINE unsigned within_cloud(const LaneGrid& grid, const WidePoint& point,
                                          float slack) {
  const InGrid found = look_up(grid, point);
  const Wide limit = all(grid.cell / 2 - 4 * slack);
  return below(found.distance, all(slack)) & below(absolute(found.from_middle.x), limit) &
         below(absolute(found.from_middle.y), limit) & below(absolute(found.from_middle.z), limit);
}

}  // namespace
}  // namespace kinship::collision
