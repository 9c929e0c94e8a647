#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <optional>
#include <random>
#include <string>

#include "proto/types/problem.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/is_free.hpp"
#include "robots/planning/no_path.hpp"
#include "robots/planning/region_constraint.hpp"

namespace kinship::planning {

class SearchRecorder;
class TreePair;

struct BirrtOptions {
  double step = 0.1;       ///< between checked configurations, joint units
  double overshoot = 1.5;  ///< extend towards q_near + f (q_sample - q_near), clamped to the bounds
  std::uint64_t max_checks = 100'000;
  std::chrono::duration<double> time_limit{10};  ///< wall clock
  /// Largest fraction of checks spent on tracks at which the next track is begun, 0 to 1.
  double track_check_fraction = 0.3;
  SearchRecorder* recorder = nullptr;  ///< records how the trees grow; borrowed for the plan
  /// Gets the trees when the search ends, at no cost to it; null: they are dropped. Not from OMPL's
  /// planners.
  TreePair* trees = nullptr;
};

struct PlanSummary {
  /// dof x n, n >= 2, at most `step` apart; absent if unsolved.
  std::optional<Eigen::MatrixXd> waypoints;
  std::uint64_t collision_checks = 0;  ///< configurations checked by `is_free`
  std::uint64_t projections = 0;       ///< onto a constraint
  std::uint64_t iterations = 0;
  std::uint64_t tracks_followed = 0;    ///< tracks of the sampler
  FoundBy found_by = FoundBy::Nothing;  ///< the part of the search that found the path
  double planning_time_s = 0;        ///< CPU time of the thread, sampling and projections included
  NoPath reason = NoPath::None;      ///< why unsolved
  std::string planner_message = {};  ///< message of a planner of OMPL that gave up
};

/// Bi-directional RRT with greedy extension of both trees, in the style of CBiRRT2 without
/// constraints. Every goal configuration is a root of the goal tree. First the straight lines from
/// the start to the goals are tried, the nearest first, until they have cost 100 checks. Then the
/// planner follows the sampler's tracks, if any, from their goals until they are blocked, whenever
/// tracks have cost no more than their fraction of the checks. Otherwise each iteration extends the
/// tree with fewer nodes towards a sample (overshot) until it is blocked and, if it grew, the other
/// tree towards its new end. After 300 samples at most nine of ten are guided, so that a mixture
/// without the solution delays a path and never prevents it. Every waypoint was checked, start and
/// goal included. If the start is a free goal, the path is [start, goal], without an iteration.
/// Equal seed, equal path, as long as the time limit does not end it.
/// \param start  dof.
/// \param goals  dof x n; colliding ones are left out.
/// \throws std::invalid_argument if sizes differ, a value is not finite, the step not positive or
///         the overshoot below 1.
/// Source: Berenson, Srinivasa, Kuffner, Task Space Regions (2011), algorithm 1.
PlanSummary plan_birrt(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                       const IsFree& is_free, const ConfigurationSampler& sampler,
                       const BirrtOptions& options, std::mt19937_64& generator);

/// The conditions on the configurations of a constrained plan; borrows both.
struct ConstrainedFreedom {
  const IsFree& is_free;
  RegionConstraint& constraint;  ///< its bounds are those of the sampler; counts the projections
};

/// Constrained bi-directional RRT: the search of plan_birrt, but every step is projected onto the
/// constraint, and an extension slides along it towards its target as long as it comes nearer.
/// Waypoints are at most `step` apart, each within RegionConstraint::kWaypointTolerance of the
/// region, and the line between two within kBetweenTolerance. A goal off the constraint is left
/// out; a start or goal off it is not checked for collisions. Reasons besides those of plan_birrt:
/// StartOffConstraint and GoalsOffConstraint.
/// \throws std::invalid_argument as plan_birrt.
/// Source: Berenson, Srinivasa and Kuffner, Task Space Regions (IJRR 2011), section 5.
PlanSummary plan_cbirrt2(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                         const ConstrainedFreedom& freedom, const ConfigurationSampler& sampler,
                         const BirrtOptions& options, std::mt19937_64& generator);

/// The conditions on the configurations of a plan; borrows both.
struct Freedom {
  const IsFree& is_free;
  RegionConstraint* constraint = nullptr;  ///< as of ConstrainedFreedom; null: none
};

/// plan_cbirrt2 along a constraint, plan_birrt without one.
PlanSummary plan_trees(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                       const Freedom& freedom, const ConfigurationSampler& sampler,
                       const BirrtOptions& options, std::mt19937_64& generator);

}  // namespace kinship::planning
