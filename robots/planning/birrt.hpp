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

namespace kinship::planning {

class SearchRecorder;

struct BirrtOptions {
  double step = 0.1;       ///< between checked configurations, joint units
  double overshoot = 1.5;  ///< extend towards q_near + f (q_sample - q_near), clamped to the bounds
  std::uint64_t max_checks = 100'000;
  std::chrono::duration<double> time_limit{10};  ///< wall clock
  /// Of the checks that may have gone into following tracks when the next one is begun, 0 to 1.
  double track_check_fraction = 0.3;
  SearchRecorder* recorder = nullptr;  ///< writes down how the trees grow; borrowed for the plan
};

struct PlanSummary {
  /// dof x n, n >= 2, at most `step` apart; absent if unsolved.
  std::optional<Eigen::MatrixXd> waypoints;
  std::uint64_t collision_checks = 0;  ///< configurations asked of `is_free`
  std::uint64_t projections = 0;       ///< onto a constraint
  std::uint64_t iterations = 0;
  std::uint64_t tracks_followed = 0;    ///< of the sampler's
  FoundBy found_by = FoundBy::Nothing;  ///< what brought the path
  double planning_time_s = 0;        ///< CPU time of the thread, sampling and projections included
  NoPath reason = NoPath::None;      ///< why unsolved
  std::string planner_message = {};  ///< what a planner of OMPL said that gave up
};

/// Bi-directional RRT with greedy extension of both trees, in the style of CBiRRT2 without
/// constraints. Every goal configuration is a root of the goal tree. First the straight lines from
/// the start to the goals are tried, the nearest first, until they have cost 100 checks. Then the
/// sampler's tracks, if it has any, are followed from their goals on until something is in the way,
/// each time that they have cost no more than their part of the checks. Otherwise each iteration
/// extends the tree with fewer nodes towards a sample (overshot) until something is in the way and,
/// if it came anywhere, the other tree towards where that was. After 300 samples at most nine of
/// ten are guided, so that a mixture which does not cover the way out delays a path and never
/// prevents it.
/// Every waypoint was checked, start and goal included. A start that is a free goal is answered
/// with [start, goal], without an iteration.
/// Equal seed, equal path, as long as the time limit does not end it.
/// \param start  dof.
/// \param goals  dof x n; colliding ones are left out.
/// \throws std::invalid_argument if sizes differ, a value is not finite, the step not positive or
///         the overshoot below 1.
/// Source: Berenson, Srinivasa, Kuffner, Task Space Regions (2011), algorithm 1.
PlanSummary plan_birrt(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                       const IsFree& is_free, const ConfigurationSampler& sampler,
                       const BirrtOptions& options, std::mt19937_64& generator);

}  // namespace kinship::planning
