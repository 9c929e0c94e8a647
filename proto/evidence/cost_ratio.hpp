#pragma once

#include <cstddef>
#include <span>

#include "proto/types/advice.hpp"

namespace kinship::evidence {

/// Estimate of log(cost of a uniform query / cost of a guided one): above 0 guidance helps.
struct CostRatio {
  double mean = 0;
  double variance = 1;
  double guided_is_cheaper = 0.5;  ///< probability, 0 to 1
  bool is_compared = false;  ///< whether both modes had attempts with a cost; else it is the prior
  bool is_by_time = false;   ///< processor times were compared, else collision checks

  /// Of the ratio itself, standard deviates from its median; as if the belief were normal.
  double quantile(double deviates) const;
};

/// The weight of an attempt halves after this many others of either mode.
inline constexpr double kHalfLife = 400;

/// Attempts with a time that a mode needs before its others, whose time is unknown, are left out.
inline constexpr std::size_t kMinTimed = 10;

/// Estimates the worth of guidance from judged attempts.
///
/// The cost of an attempt is its processor time, scaled to a machine of speed 1: what guidance
/// takes to compute counts, and what it saves in checks alone does not. Collision checks are
/// compared as long as a mode has attempts without a time and fewer than kMinTimed with one.
///
/// The cost of an attempt is log-normal about the level of the task, which both modes share and
/// which may wander, and the effect of guidance:
///
///     log(cost) = level -+ log(ratio) / 2 + noise,   - guided, + control
///
/// A Kalman filter (drift_filter.hpp) follows level and effect through the attempts, so each is
/// compared with its neighbours in time: a change that makes the task dearer for both modes moves
/// the level, not the ratio. The speed at which level and effect wander is unknown: six filters
/// with different speeds, from zero to very fast, run side by side and are averaged by how well
/// they predicted the attempts. No attempt is dropped; an attempt's weight is 2^(-age / kHalfLife).
///
/// - An unsolved attempt is censored: it would have cost as much or more.
/// - One report moves little: log(cost) is brought to within 3.5 robust standard deviations of
///   the median of all, and to within 3 of a filter's prediction.
/// - Attempts without a cost are left out. Without any of a mode the answer is the prior: a ratio
///   of 1 / 0.7, give or take a factor e.
///
/// Typical queries are compared (geometric means), not sums: a few very dear queries of one mode
/// weigh no more than as many clearly dearer ones. Scaling the costs of both modes by a factor
/// does not change the ratio.
///
/// \param recent  oldest first, age falling.
/// Sources: West and Harrison, Bayesian Forecasting and Dynamic Models (1997), section 4.5 (filter
/// with unknown variance) and 12.2 (several models side by side); Raftery et al., Online Prediction
/// Under Model Uncertainty via Dynamic Model Averaging (2010); Huber, Robust Statistics (1981),
/// section 1.7 (bounding).
CostRatio compare_costs(std::span<const JudgedAttempt> recent);

}  // namespace kinship::evidence
