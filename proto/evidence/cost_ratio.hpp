#pragma once

#include <span>

#include "proto/types/advice.hpp"

namespace kinship::evidence {

/// What is believed of log(cost of a guided query / cost of a uniform one): a normal distribution.
struct CostRatio {
  double mean = 0;
  double variance = 1;
  bool is_compared = false;  ///< whether both arms had attempts with checks; else it is the prior

  double guided_is_cheaper() const;  ///< probability, 0 to 1
  double quantile(
      double deviates) const;  ///< of the ratio itself, standard deviates from its median
};

/// How evidence ages: an attempt weighs half as much after so many others.
inline constexpr double kHalfLifeInMode = 40;   ///< newer attempts of the same arm
inline constexpr double kHalfLifeInTask = 150;  ///< newer attempts of either arm

/// What judged attempts say about the worth of guidance.
///
/// The cost of an arm is its collision checks / its solutions, both summed with weights
/// 2^(-newer of the arm / kHalfLifeInMode) 2^(-newer of either / kHalfLifeInTask): an unsolved
/// attempt is censored, so its checks count and it adds no solution; an arm without solutions
/// counts as if it had one. log(cost) is taken as normal; its variance is, by the delta method for
/// a ratio of two correlated means,
///
///     (cv(checks)^2 + cv(solved)^2 - 2 cov(checks, solved) / (means)) / sum of weights
///
/// with cv = standard deviation / mean, the numerator drawn towards 1 as by 4 further attempts
/// (what planners' checks have mostly). The difference of both arms meets a prior: the ratio is
/// 0.7, give or take a factor e.
///
/// **A task that changes.** If the newest 2 to 6 attempts of an arm lie more than 3 standard errors
/// from those before, in their mean log(checks), those before count no more: guidance that has gone
/// wrong is found out in a few queries, not in a half-life.
///
/// Scaling the checks of both arms changes nothing, and dearer guided attempts never make guidance
/// look cheaper.
///
/// \param recent  oldest first.
/// Source of the variance: Casella and Berger, Statistical Inference (2002), example 5.5.27. Of
/// discounting under change: Garivier and Moulines, On Upper-Confidence Bound Policies for
/// Switching Bandit Problems (2011).
CostRatio compare_costs(std::span<const JudgedAttempt> recent);

}  // namespace kinship::evidence
