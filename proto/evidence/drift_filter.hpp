#pragma once

namespace kinship::evidence {

/// One attempt as input of a drift filter.
struct LogCost {
  double value = 0;          ///< log(processor time) or log(checks)
  double effect = 0;         ///< of guidance: -1/2 guided, +1/2 control
  bool is_censored = false;  ///< it would have needed more
  double gap = 0;            ///< judged attempts since the one before
  double weight = 1;         ///< above 0, at most 1
};

/// Follows a level and the effect of guidance, both of which may wander, through attempts.
///
/// State (level, log ratio), observation level + effect x log ratio + noise of variance V / weight;
/// V is learned with the state (conjugate, inverse gamma). All covariances are in units of V. A
/// censored attempt moves the state to its mean and variance given that the cost is above a
/// bound (moments of a truncated normal distribution).
/// Source: West and Harrison, Bayesian Forecasting and Dynamic Models (1997), section 4.5; Johnson,
/// Kotz and Balakrishnan, Continuous Univariate Distributions 1 (1994), section 13.10.
class DriftFilter {
 public:
  /// How far level and log ratio wander from one attempt to the next, in standard deviations of an
  /// attempt.
  struct Steps {
    double level = 0;
    double ratio = 0;
  };

  /// \param level  prior mean of the level, give or take two standard deviations.
  DriftFilter(Steps steps, double level);

  void add(const LogCost& cost);

  double ratio() const noexcept { return ratio_; }                    ///< mean of the log ratio
  double variance() const;                                            ///< of the log ratio
  double log_likelihood() const noexcept { return log_likelihood_; }  ///< of the attempts added

 private:
  Steps steps_;
  double level_;
  double ratio_;
  double of_level_, of_both_ = 0, of_ratio_;  // covariance, in units of the spread
  double freedom_;                            // degrees of it behind the spread
  double spread_;                             // V
  double log_likelihood_ = 0;
};

inline constexpr double kPriorLogRatio = 0.35667;  ///< -log 0.7
inline constexpr double kPriorVariance = 1;        ///< of the log ratio

}  // namespace kinship::evidence
