#include "server/service/advice_rule.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace kinship::service {
namespace {

constexpr double kQuantile90 = 1.6449;  // two-sided, of the normal distribution
constexpr double kSolutionsOfNone = 0.5;

/// An interval of a ratio, in logarithms.
struct LogInterval {
  double middle = 0, low = 0, high = 0;
};

std::optional<ArmEvidence> evidence_of(const store::ArmTotals& totals) {
  if (totals.attempts == 0)
    return std::nullopt;
  ArmEvidence arm{totals.attempts, totals.solved, 0};
  if (totals.solved > 0)
    arm.checks_per_solution = totals.checks / static_cast<double>(totals.solved);
  return arm;
}

double solutions(const store::ArmTotals& totals) {
  return totals.solved > 0 ? static_cast<double>(totals.solved) : kSolutionsOfNone;
}

/// Variance of log(cost). Needs attempts > 1 and checks > 0.
double log_variance(const store::ArmTotals& totals) {
  const auto attempts = static_cast<double>(totals.attempts);
  const double mean_checks = totals.checks / attempts;
  const double mean_solved = solutions(totals) / attempts;
  // Relative to the means, so that no square of a large number of checks is left.
  const double relative_checks =
      std::max(0.0, totals.checks_squared / attempts / (mean_checks * mean_checks) - 1);
  const double relative_solved = (1 - mean_solved) / mean_solved;
  const double relative_both =
      totals.solved > 0 ? totals.checks_of_solved / attempts / (mean_checks * mean_solved) - 1 : 0;
  return std::max(0.0, (relative_checks + relative_solved - 2 * relative_both) / (attempts - 1));
}

LogInterval compare(const store::AttemptTotals& totals) {
  const auto log_cost = [](const store::ArmTotals& arm) {
    return std::log(arm.checks) - std::log(solutions(arm));
  };
  LogInterval interval;
  interval.middle = log_cost(totals.guided) - log_cost(totals.control);
  const double half =
      kQuantile90 * std::sqrt(log_variance(totals.guided) + log_variance(totals.control));
  interval.low = interval.middle - half;
  interval.high = interval.middle + half;
  return interval;
}

/// The part of the interval in which guidance is better.
double part_below_zero(const LogInterval& interval) {
  if (interval.high <= 0)
    return 1;
  if (interval.low >= 0)
    return 0;
  return -interval.low / (interval.high - interval.low);
}

std::string text(const char* format, double value) {
  char words[32];
  std::snprintf(words, sizeof words, format, value);
  return words;
}

std::string in_words(const char* arm, const char* unit, const store::ArmTotals& totals) {
  const std::string attempts = std::to_string(totals.attempts);
  if (totals.solved == 0)
    return std::string(arm) + " none solved in " + attempts;
  return arm + text(" %.0f", totals.checks / static_cast<double>(totals.solved)) + unit + " in " +
         attempts;
}

std::string in_words(const LogInterval& interval) {
  std::string words = text("ratio %.2f", std::exp(interval.middle));
  words +=
      text(" (90 %% %.2f", std::exp(interval.low)) + text(" to %.2f)", std::exp(interval.high));
  if (interval.high <= 0)
    return words + ", clearly better: share of the profile";
  if (interval.low >= 0)
    return words + ", clearly worse: uniform";
  return words + ", undecided: part of the profile's share";
}

}  // namespace

Advice advise(const store::AttemptTotals& totals, double profile_share) {
  Advice advice;
  advice.recommended_share = std::clamp(profile_share, 0.0, 1.0);
  advice.guided_share = advice.recommended_share;
  advice.guided = evidence_of(totals.guided);
  advice.control = evidence_of(totals.control);
  if (std::min(totals.guided.attempts, totals.control.attempts) < kLeastAttempts) {
    advice.evidence = std::to_string(totals.guided.attempts) + " guided and " +
                      std::to_string(totals.control.attempts) +
                      " control attempts, compared from " + std::to_string(kLeastAttempts) +
                      " of each on: share of the profile";
    return advice;
  }
  if (!(totals.guided.checks > 0) || !(totals.control.checks > 0)) {
    advice.evidence = std::string(totals.guided.checks > 0 ? "control" : "guided") +
                      " attempts report no collision checks: share of the profile";
    return advice;
  }
  const LogInterval interval = compare(totals);
  advice.recommended_share *= part_below_zero(interval);
  advice.evidence = in_words("guided", " checks per solution", totals.guided) + " attempts, " +
                    in_words("control", "", totals.control) + ": " + in_words(interval);
  return advice;
}

}  // namespace kinship::service
