#pragma once

#include <cstddef>
#include <vector>

namespace kinship::experiments {

/// How a p-value was computed.
enum class WilcoxonMethod { Exact, NormalApproximation };

struct WilcoxonSummary {
  std::size_t pairs = 0;     ///< that differ
  std::size_t dropped = 0;   ///< pairs without a difference (both infinite included)
  double rank_sum_plus = 0;  ///< of the pairs whose first value is the greater one
  double rank_sum_minus = 0;
  double p = 1;  ///< two-sided; 1 if no pair differs
  WilcoxonMethod method = WilcoxonMethod::Exact;
};

/// Two-sided Wilcoxon signed-rank test for pairs (first[i], second[i]).
///
/// Pairs without a difference are dropped (Wilcoxon's own rule); equal differences share the mean
/// of their ranks. An infinite value is worse than any finite one: such differences are the
/// largest and equal to each other; infinite against infinite is no difference.
/// Up to kMaxExactPairs pairs, p is exact under the permutation of signs, also with shared ranks;
/// beyond, the normal approximation with corrections for ties and continuity.
/// \throws std::invalid_argument if the lengths differ or a value is NaN.
/// Source: Hollander, Wolfe, Chicken, Nonparametric Statistical Methods (2014), section 3.1.
WilcoxonSummary wilcoxon_signed_rank(const std::vector<double>& first,
                                     const std::vector<double>& second);

inline constexpr std::size_t kMaxExactPairs = 200;

}  // namespace kinship::experiments
