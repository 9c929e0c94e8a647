#pragma once

#include <array>

#include "robots/inverse/axis.hpp"
#include "robots/inverse/subproblems.hpp"

namespace kinship::inverse {

/// Relation of two neighbours, the first two or the last two, among three axes that place a point.
enum class PointRule { FirstMeet, FirstParallel, LastMeet, LastParallel };

/// The solution rule of a chain of six turning joints. If `reversed`, it applies to the chain read
/// from tip to base.
struct SixJointRule {
  enum class Kind {
    SphericalWrist,  ///< axes 4, 5, 6 meet; axes 1, 2, 3 place that point by `point`
    ThreeParallel,   ///< axes 2, 3, 4 parallel; 5 and 6 meet
  };
  Kind kind = Kind::SphericalWrist;
  bool reversed = false;
  PointRule point = PointRule::FirstMeet;  ///< of SphericalWrist

  bool operator==(const SixJointRule&) const = default;
};

inline constexpr int kMaxBranches = 8;  ///< of six joints by these rules

/// Solutions for six joints: one column of angles (rad, any turn) per branch.
struct SixJointBranches {
  std::array<std::array<double, 6>, kMaxBranches> angles;
  int count = 0;
  bool outside = false;  ///< whether a joint outside its window has cut off branches

  void add(const std::array<double, 6>& q) {
    if (count < kMaxBranches)
      angles[static_cast<std::size_t>(count++)] = q;
  }
};

/// A problem of six turning joints.
struct SixJointTask {
  std::array<Axis, 6> axes;
  Displacement wanted;
  std::array<TurnWindow, 6> windows;  ///< branches with a joint outside its own are left out
  /// Largest excess of a step's target beyond the boundary of its reach (share of the reach); the
  /// step then ends at the boundary.
  double slack = 0;
};

/// All branches of six turning joints whose displacements, from base to tip, make `wanted`. Axes of
/// a wrist have the point where they meet as their point, parallel axes one direction (or its
/// opposite): the rule is applied without a check that it holds.
SixJointBranches solve_six_joints(const SixJointTask& task, const SixJointRule& rule);

}  // namespace kinship::inverse
