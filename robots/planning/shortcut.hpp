#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

#include "robots/planning/is_free.hpp"
#include "robots/planning/region_constraint.hpp"

namespace kinship::planning {

struct ShortcutOptions {
  double step = 0.1;  ///< between checked configurations, joint units
  /// In checks, not in time: a long budget concentrates the paths of a fleet, and a prior fitted
  /// to them helps less.
  std::uint64_t max_checks = 300;
};

struct ShortcutSummary {
  /// dof x n: a path from the same start to the same goal, no longer than the given one. Without a
  /// constraint its vertices, so that all configurations of `densified` at the step were checked;
  /// under a constraint every waypoint.
  Eigen::MatrixXd waypoints;
  std::uint64_t collision_checks = 0;
  std::uint64_t projections = 0;  ///< onto a constraint
};

/// Shortens a free path: tries straight lines between two random places of it, and takes free and
/// shorter ones, proven if `is_free` proves edges, until the budget is used up or many tries in a
/// row failed.
/// \param waypoints  dof x n, n >= 1, free where `densified` at the step visits it.
/// \throws std::invalid_argument if there is no waypoint or the step is not positive.
/// Source: Geraerts and Overmars, Creating High-quality Paths for Motion Planning (2007), III-B.
ShortcutSummary shortcut(const Eigen::MatrixXd& waypoints, const IsFree& is_free,
                         const ShortcutOptions& options, std::mt19937_64& generator);

/// Shortens a path that keeps to a constraint: instead of a straight line it tries a way along the
/// region, in steps as those of plan_cbirrt2. The result has the guarantees of plan_cbirrt2.
/// \param waypoints  dof x n, n >= 1, as plan_cbirrt2 returns them at options.step.
/// \throws std::invalid_argument as above.
ShortcutSummary shortcut_constrained(const Eigen::MatrixXd& waypoints, const IsFree& is_free,
                                     RegionConstraint& constraint, const ShortcutOptions& options,
                                     std::mt19937_64& generator);

/// shortcut_constrained along a constraint, shortcut without one. \param constraint  null: none.
ShortcutSummary shortcut(const Eigen::MatrixXd& waypoints, const IsFree& is_free,
                         RegionConstraint* constraint, const ShortcutOptions& options,
                         std::mt19937_64& generator);

}  // namespace kinship::planning
