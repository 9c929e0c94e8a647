#pragma once

#include <array>

#include "robots/inverse/axis.hpp"
#include "robots/inverse/subproblems.hpp"

namespace kinship::inverse {

/// How three axes that place a point are told apart: by two neighbours of them, the first two or
/// the last two.
enum class PointRule { FirstMeet, FirstParallel, LastMeet, LastParallel };

/// How a chain of six turning joints is solved. If `reversed`, all of it is meant for the chain
/// read from tip to base.
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

/// What six joints come to: one column of angles (rad, any turn) per branch.
struct SixJointBranches {
  std::array<std::array<double, 6>, kMaxBranches> angles;
  int count = 0;
  bool outside = false;  ///< whether a joint would have left its window on the way to a branch

  void add(const std::array<double, 6>& q) {
    if (count < kMaxBranches)
      angles[static_cast<std::size_t>(count++)] = q;
  }
};

/// What is asked of six turning joints.
struct SixJointTask {
  std::array<Axis, 6> axes;
  Displacement wanted;
  std::array<TurnWindow, 6> windows;  ///< branches with a joint outside its own are left out
  /// How far beyond the boundary of what it can reach a step may be asked to go (share of its
  /// reach); it then goes to the boundary.
  double slack = 0;
};

/// All branches of six turning joints whose displacements, from base to tip, make `wanted`.
/// Axes of a wrist have the point where they meet as their point, parallel axes one direction (or
/// its opposite): the rule is followed without looking whether it holds.
SixJointBranches solve_six_joints(const SixJointTask& task, const SixJointRule& rule);

}  // namespace kinship::inverse
