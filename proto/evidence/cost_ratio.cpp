#include "proto/evidence/cost_ratio.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

namespace kinship::evidence {
namespace {

constexpr double kPriorLogRatio = -0.35667;  // log 0.7
constexpr double kPriorVariance = 1;         // of the log ratio
constexpr double kPriorSpread = 1;           // relative variance of one attempt's cost
constexpr double kPriorAttempts = 4;         // that the prior spread is worth
constexpr double kPriorLogSpread = 0.5;      // variance of one attempt's log(checks)
constexpr std::ptrdiff_t kMinOfChange = 2, kMaxOfChange = 6;  // newest attempts, compared ...
constexpr std::ptrdiff_t kMinBeforeChange = 3;                // ... with those before
constexpr double kChange = 3;                                 // standard errors

/// Mean log(checks) of one arm and the standard error of its logarithm.
struct LogCost {
  double value = 0;
  double variance = 0;
};

double log_checks(const JudgedAttempt& attempt) {
  return std::log(std::max(1.0, static_cast<double>(attempt.checks)));
}

/// How many standard errors the last `newest` attempts lie from those before.
double surprise(std::span<const JudgedAttempt> mode, std::ptrdiff_t newest) {
  const auto last = mode.last(static_cast<std::size_t>(newest));
  const auto before = mode.first(mode.size() - last.size());
  double sum_last = 0, sum = 0, squares = 0;
  for (const JudgedAttempt& attempt : last)
    sum_last += log_checks(attempt);
  for (const JudgedAttempt& attempt : before) {
    sum += log_checks(attempt);
    squares += log_checks(attempt) * log_checks(attempt);
  }
  const auto n = static_cast<double>(before.size()), m = static_cast<double>(last.size());
  const double deviations = std::max(0.0, squares - sum * sum / n);
  const double spread = (deviations + kPriorAttempts * kPriorLogSpread) / (n - 1 + kPriorAttempts);
  return std::abs(sum_last / m - sum / n) / std::sqrt(spread * (1 / m + 1 / n));
}

/// The attempts since the last change, if there was one that shows.
std::span<const JudgedAttempt> since_change(std::span<const JudgedAttempt> mode) {
  const auto size = static_cast<std::ptrdiff_t>(mode.size());
  double greatest = kChange;
  std::ptrdiff_t kept = size;
  for (std::ptrdiff_t newest = kMinOfChange;
       newest <= kMaxOfChange && size - newest >= kMinBeforeChange; ++newest) {
    const double standard_errors = surprise(mode, newest);
    if (standard_errors > greatest) {
      greatest = standard_errors;
      kept = newest;
    }
  }
  return mode.last(static_cast<std::size_t>(kept));
}

double weight_of(const JudgedAttempt& attempt, std::size_t newer_in_mode) {
  return std::exp2(-static_cast<double>(newer_in_mode) / kHalfLifeInMode -
                   static_cast<double>(attempt.age) / kHalfLifeInTask);
}

/// Weighted sums over one arm.
struct Sums {
  double weight = 0, solved = 0, checks = 0, checks_squared = 0, checks_of_solved = 0;

  explicit Sums(std::span<const JudgedAttempt> mode) {
    for (std::size_t i = 0; i < mode.size(); ++i) {
      const double w = weight_of(mode[i], mode.size() - 1 - i);
      const auto c = static_cast<double>(mode[i].checks);
      weight += w;
      checks += w * c;
      checks_squared += w * c * c;
      if (mode[i].solved) {
        solved += w;
        checks_of_solved += w * c;
      }
    }
  }
};

/// Relative variance of one attempt's contribution to checks / solutions.
double spread_of(const Sums& sums, double solutions) {
  const double mean_checks = sums.checks / sums.weight;
  const double mean_solved = std::min(1.0, solutions / sums.weight);
  // Relative to the means, so that no square of a large number of checks is left.
  const double of_checks = sums.checks_squared / sums.weight / (mean_checks * mean_checks) - 1;
  const double of_solved = (1 - mean_solved) / mean_solved;
  const double of_both =
      sums.solved > 0 ? sums.checks_of_solved / sums.weight / (mean_checks * mean_solved) - 1 : 0;
  return std::max(0.0, of_checks + of_solved - 2 * of_both);
}

/// Nothing if the arm has no attempts that a cost could be told from.
std::optional<LogCost> log_cost(std::span<const JudgedAttempt> recent, SamplingMode mode) {
  std::vector<JudgedAttempt> own;
  std::copy_if(recent.begin(), recent.end(), std::back_inserter(own),
               [mode](const JudgedAttempt& one) { return one.sampling_mode == mode; });
  const Sums sums(since_change(own));
  if (!(sums.checks > 0) || !(sums.weight > 0))
    return std::nullopt;
  const double solutions = std::max(sums.solved, std::min(1.0, sums.weight));
  const double spread = (sums.weight * spread_of(sums, solutions) + kPriorAttempts * kPriorSpread) /
                        (sums.weight + kPriorAttempts);
  return LogCost{std::log(sums.checks) - std::log(solutions), spread / sums.weight};
}

}  // namespace

double CostRatio::guided_is_cheaper() const {
  return std::erfc(mean / std::sqrt(2 * variance)) / 2;
}

double CostRatio::quantile(double deviates) const {
  return std::exp(mean + deviates * std::sqrt(variance));
}

CostRatio compare_costs(std::span<const JudgedAttempt> recent) {
  const auto guided = log_cost(recent, SamplingMode::Guided);
  const auto control = log_cost(recent, SamplingMode::Control);
  if (!guided || !control)
    return {kPriorLogRatio, kPriorVariance, false};
  const double precision = 1 / (guided->variance + control->variance);
  const double prior_precision = 1 / kPriorVariance;
  const double variance = 1 / (precision + prior_precision);
  const double mean =
      variance * (precision * (guided->value - control->value) + prior_precision * kPriorLogRatio);
  return {mean, variance, true};
}

}  // namespace kinship::evidence
