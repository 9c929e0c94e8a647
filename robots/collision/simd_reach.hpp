// Distances of points and forms, KINSHIP_SIMD_WIDTH at once. Included only by the units that are
// compiled for one instruction set, after simd_floats.hpp.

#include "robots/collision/lanes.hpp"

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

}  // namespace
}  // namespace kinship::collision
