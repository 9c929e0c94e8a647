#pragma once

#include <cstdint>
#include <limits>

#include "client/guided/planner_choice.hpp"
#include "robots/planning/guided_sampler.hpp"

namespace kinship::guided {

/// Range of `PlanSettings::resolution`, joint units.
inline constexpr double kLeastResolution = 1e-4, kLargestResolution = 1;

/// The queries whose PlannedProblem has a search record, and so their reports.
enum class RecordSearch {
  Never,
  Failed,  ///< unsolved ones, without trees
  Slow,    ///< unsolved ones, and those slower than PlanSettings::slow_time_s; with trees
  All      ///< with trees
};

/// How every problem of a run is planned, guided or not.
struct PlanSettings {
  double resolution = 0.05;  ///< between checked configurations, joint units
  /// Bodies nearer than this count as touching, and all edges of a path are proven (see
  /// collision::EdgeProofOptions), m; 0: edges are only checked at the resolution.
  double clearance_m = 1e-3;
  double overshoot = 1.5;               ///< see planning::BirrtOptions
  std::uint64_t max_checks = 100'000;   ///< of planning, without goals and shortcutting
  std::uint64_t shortcut_checks = 300;  ///< at most, each time a path is shortened; 0: never
  /// A start or goal beyond a limit by less is moved onto it, joint units; 0: refused.
  double limit_slack = 1e-4;
  int max_goals = 20;  ///< goal configurations found for a goal pose
  /// Beyond it a mixture gives fewer samples, far beyond it none (planning::query_distance).
  double gate_distance = planning::kGateDistance;
  planning::TrackOptions tracks = {};  ///< of guided queries with experience
  PlannerChoice planner = {};
  RecordSearch record_search = RecordSearch::Failed;
  double slow_time_s = std::numeric_limits<double>::infinity();  ///< processor time
};

}  // namespace kinship::guided
