// Planes between two forms, KINSHIP_SIMD_WIDTH pairs at once. Included only by the units that are
// compiled for one instruction set.
#pragma once

#include "robots/collision/lanes.hpp"
#include "robots/collision/simd_floats.hpp"

namespace kinship::collision {
namespace {

/// Pose of a form.
struct WideForm {
  WidePoint axis[3];
  WidePoint center;
};

KINSHIP_SIMD_INLINE WidePoint turned(const WideFrame& frame, float x, float y, float z) {
  return {frame.R[0] * x + frame.R[1] * y + frame.R[2] * z,
          frame.R[3] * x + frame.R[4] * y + frame.R[5] * z,
          frame.R[6] * x + frame.R[7] * y + frame.R[8] * z};
}

KINSHIP_SIMD_INLINE WideForm placed(const LaneForm& form, const WideFrame& frame) {
  const float(&A)[9] = form.axes;
  return {{turned(frame, A[0], A[3], A[6]), turned(frame, A[1], A[4], A[7]),
           turned(frame, A[2], A[5], A[8])},
          moved(frame, form.center)};
}

KINSHIP_SIMD_INLINE WideForm standing(const LaneForm& form) {
  const float(&A)[9] = form.axes;
  return {{{all(A[0]), all(A[3]), all(A[6])},
           {all(A[1]), all(A[4]), all(A[7])},
           {all(A[2]), all(A[5]), all(A[8])}},
          {all(form.center[0]), all(form.center[1]), all(form.center[2])}};
}

KINSHIP_SIMD_INLINE Wide dot(const WidePoint& a, const WidePoint& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

KINSHIP_SIMD_INLINE WidePoint cross(const WidePoint& a, const WidePoint& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

KINSHIP_SIMD_INLINE WidePoint minus(const WidePoint& a, const WidePoint& b, Wide share) {
  return {a.x - share * b.x, a.y - share * b.y, a.z - share * b.z};
}

KINSHIP_SIMD_INLINE bool is_box(const LaneForm& form) {
  return form.shape == LaneShape::Box || form.shape == LaneShape::AlignedBox;
}

/// Extent of a form from its centre along a direction of length `norm`, times that length.
KINSHIP_SIMD_INLINE Wide extent(const LaneForm& form, const WideForm& at, const WidePoint& n,
                                Wide norm) {
  const Wide along = dot(n, at.axis[2]);
  const Wide straight = absolute(along) * form.half[2];
  if (is_box(form))
    return straight + absolute(dot(n, at.axis[0])) * form.half[0] +
           absolute(dot(n, at.axis[1])) * form.half[1];
  if (form.shape == LaneShape::Capsule)
    return straight + norm * form.radius;
  // Not by Pythagoras: next to the axis floats would leave nothing of it.
  const WidePoint across = cross(n, at.axis[2]);
  return straight + root(dot(across, across)) * form.radius;
}

/// Largest rounding error of a distance, and the gap required between separate forms besides, m.
struct Margin {
  float slack;
  Wide growth;
};

/// The result of planes between two forms for some lanes.
struct Planes {
  unsigned apart;        ///< one lies between them
  unsigned overlapping;  ///< none does, and the forms share more than rounding could feign
};

/// Tries planes of some directions.
class Separation {
 public:
  Separation(const WideForm& a, const LaneForm& a_form, const WideForm& b, const LaneForm& b_form,
             Margin margin)
      : a_(a),
        b_(b),
        a_form_(a_form),
        b_form_(b_form),
        between_(minus(b.center, a.center, all(1))),
        slack_(margin.slack),
        room_(4 * margin.slack + margin.growth),
        rounding_(1e-6F + 6e-7F * (size(a_form) + size(b_form))) {}

  unsigned apart() const { return apart_; }
  bool is_done(unsigned open) const { return (open & ~apart_) == 0; }
  const WidePoint& between() const { return between_; }

  /// Tries a plane across a side of a box, or any other direction. One too short to be a direction
  /// separates nothing, as all distances along it are too short.
  KINSHIP_SIMD_INLINE void attempt(const WidePoint& n) {
    const Wide norm = root(dot(n, n));
    const Wide reached = extent(a_form_, a_, n, norm) + extent(b_form_, b_, n, norm);
    const Wide distance = absolute(dot(n, between_));
    apart_ |= below(reached + norm * room_ + 1e-7F, distance);
    overlapping_ &= below(distance + norm * (4 * slack_) + rounding_, reached);
    const Wide depth = reached - distance;
    depth_ = depth < depth_ ? depth : depth_;
  }

  /// Tries a plane across an edge of each of two boxes, after their sides. For nearly parallel
  /// edges the sides alone decide, if the boxes overlap by more than it takes to make them
  /// parallel.
  KINSHIP_SIMD_INLINE void attempt_edges(const WidePoint& n) {
    constexpr float kSine = 1e-3F;
    const Wide squared = dot(n, n), norm = root(squared);
    const Wide reached = extent(a_form_, a_, n, norm) + extent(b_form_, b_, n, norm);
    const Wide distance = absolute(dot(n, between_));
    apart_ |= below(reached + norm * room_ + 1e-7F, distance);
    const unsigned clearly = below(distance + norm * (4 * slack_) + rounding_, reached);
    const unsigned parallel = below(squared, all(kSine * kSine));
    const float moved = 4 * kSine * (size(a_form_) + size(b_form_));
    overlapping_ &= (clearly & ~parallel) | (parallel & below(all(moved), depth_));
  }

  unsigned overlapping() const { return overlapping_; }

 private:
  static float size(const LaneForm& box) { return box.half[0] + box.half[1] + box.half[2]; }

  const WideForm &a_, &b_;
  const LaneForm &a_form_, &b_form_;
  WidePoint between_;
  float slack_;
  Wide room_;       // between what is apart, m
  float rounding_;  // of extents and distances where shapes overlap: it grows with them, m
  unsigned apart_ = 0, overlapping_ = ~0U;
  Wide depth_ = all(1e9F);  // least overlap so far
};

/// Tries planes across the line between the centres, also without its part along either's longest
/// axis.
KINSHIP_SIMD_INLINE void attempt_others(const WideForm& a, const WideForm& b, Separation& planes) {
  const WidePoint& between = planes.between();
  planes.attempt(minus(between, a.axis[2], dot(between, a.axis[2])));
  planes.attempt(between);
  planes.attempt(minus(between, b.axis[2], dot(between, b.axis[2])));
}

/// Tries planes of the forms' axes, across an axis of each, and, if one is no box, across the line
/// between their centres, also without its part along either's longest axis. For two boxes these
/// planes are sufficient, so that they also decide overlap; for other forms they may miss a
/// separation.
/// \param open    lanes that matter; ends as soon as all of these are apart.
/// Source: S. Gottschalk, M. Lin, D. Manocha, OBBTree, SIGGRAPH 1996 (boxes).
Planes separated(const WideForm& a, const LaneForm& a_form, const WideForm& b,
                 const LaneForm& b_form, Margin margin, unsigned open) {
  Separation planes(a, a_form, b, b_form, margin);
  const bool are_boxes = is_box(a_form) && is_box(b_form);
  const int a_first = is_box(a_form) ? 0 : 2;
  const int b_first = is_box(b_form) ? 0 : 2;
  for (int i = b_first; i < 3; ++i)
    planes.attempt(b.axis[i]);
  if (planes.is_done(open))
    return {planes.apart(), 0};
  for (int i = a_first; i < 3; ++i)
    planes.attempt(a.axis[i]);
  if (!are_boxes && !planes.is_done(open))
    attempt_others(a, b, planes);
  for (int i = a_first; i < 3; ++i)
    for (int j = b_first; j < 3 && !planes.is_done(open); ++j)
      planes.attempt_edges(cross(a.axis[i], b.axis[j]));
  const bool is_decided = are_boxes && !planes.is_done(open);
  return {planes.apart(), is_decided ? planes.overlapping() : 0};
}

}  // namespace
}  // namespace kinship::collision
