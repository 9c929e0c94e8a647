#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "robots/planning/is_free.hpp"
#include "robots/recall/recall_guide.hpp"

namespace kinship::recall {

struct RecallOptions {
  double step = 0.1;  ///< between checked configurations, joint units
  /// Largest part of RecallLibrary::search_checks that tries may cost by RecallLibrary::try_checks,
  /// times the trust.
  double most_spent = 0.3;
  std::uint64_t max_checks = 100'000;  ///< after which no other path is tried
  double trust = 1;                    ///< factor of every candidate's chance, 0 to 1
};

struct RecallSummary {
  /// dof x n: from the start to a goal, every configuration at most `step` apart free, and every
  /// line proven if `is_free` proves them; missing: no candidate was free.
  std::optional<Eigen::MatrixXd> waypoints;
  std::uint64_t collision_checks = 0;
  std::uint64_t tries = 0;
  bool is_straight_line = false;  ///< the straight line to the first goal tried was free
  /// The first candidates that failed though their goal was free; they borrow guide and constraint.
  std::vector<Warp> failed;
  double expected = 0;  ///< chance that one of the tries works, by the ranking, 0 to 1
};

/// All waypoints of candidates that failed, for TrackQuery::failed_paths.
std::vector<Eigen::MatrixXd> whole(std::vector<Warp>& failed);

/// Whether a path's goal is free, and keeps the constraint. \param summary  out: checks are added.
bool is_goal_free(const Warp& warp, const planning::IsFree& is_free, RecallSummary& summary);

/// Whether a path with a free goal is free: it is computed and checked at few waypoints first, then
/// at all, then between these.
/// \param summary  out: checks are added; if it is free, its waypoints.
bool is_way_free(Warp& warp, const planning::IsFree& is_free, double step, RecallSummary& summary);

/// Tries whole paths on a query, the most promising first, as long as that is cheaper in the mean
/// than a search. A path is checked at few configurations first, then between these. The straight
/// line to the first free goal is tried before its path, but under a constraint. Equal arguments,
/// equal answers.
/// \param query  start and goals need not be free.
RecallSummary recall(const RecallGuide& guide, const Query& query, const planning::IsFree& is_free,
                     const RecallOptions& options);

}  // namespace kinship::recall
