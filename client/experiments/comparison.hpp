#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "client/experiments/wilcoxon.hpp"
#include "client/guided/unplanned_problems.hpp"
#include "proto/types/problem.hpp"
#include "proto/types/result.hpp"

namespace kinship::experiments {

/// What one planner did on the problems that both planners answered.
///
/// Means count an unsolved attempt with what it had used when it gave up (a lower bound); medians
/// count it as worse than any solved one, so a median is infinite if half are unsolved.
struct PlannerStatistics {
  std::size_t solved = 0;
  std::size_t with_guidance = 0;  ///< attempts that drew from a distribution
  double mean_checks = 0;
  double median_checks = 0;
  double mean_time_s = 0;
  double median_time_s = 0;
};

/// Uniform against guided planning over the same problems. A problem that a side began no search
/// for is no pair.
struct Comparison {
  std::size_t pairs = 0;
  std::size_t proven_by_one = 0;  ///< pairs of paths of which one is proven, the other is not
  PlannerStatistics uniform;
  PlannerStatistics guided;
  double mean_checks_ratio = 0;  ///< uniform / guided
  double median_checks_ratio = 0;
  double mean_time_ratio = 0;
  double median_time_ratio = 0;
  WilcoxonSummary checks_test;  ///< unsolved = infinite; both unsolved = no difference
  WilcoxonSummary time_test;
  std::vector<std::string> unpaired;    ///< names that only one side answered
  guided::UnplannedProblems unplanned;  ///< answered by both, and by one without a search
};

/// The comparison of uniform planning with something else than what is compared first, e.g. with
/// one guide alone.
struct AlsoCompared {
  std::string name;  ///< for people
  Comparison comparison;
};

/// Pairs results by name and compares them.
/// \return InvalidInput if a name occurs twice on one side, or no problem was planned by both.
Result<Comparison> compare(const std::vector<ProblemResult>& uniform,
                           const std::vector<ProblemResult>& guided);

}  // namespace kinship::experiments
