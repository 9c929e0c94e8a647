#include "proto/evidence/drift_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace kinship::evidence {
namespace {

constexpr double kPriorSpread = 0.8;       // variance of one attempt's log(cost)
constexpr double kPriorFreedom = 4;        // attempts that it is worth
constexpr double kLevelVariance = 4;       // in units of the spread
constexpr double kMaxLevelVariance = 100;  // after a long gap
constexpr double kMaxRatioVariance = 4;
constexpr double kBound = 3;  // standard deviations of one attempt from the forecast, at most

double upper_tail(double deviates) { return std::erfc(deviates / std::numbers::sqrt2) / 2; }

/// Mean of a standard normal variable that is above a bound of at most kBound.
double mean_above(double bound) {
  return std::exp(-bound * bound / 2) / std::sqrt(2 * std::numbers::pi) / upper_tail(bound);
}

/// Log of the factor of Student's density.
double log_factor(double freedom) {
  return std::lgamma((freedom + 1) / 2) - std::lgamma(freedom / 2) -
         std::log(freedom * std::numbers::pi) / 2;
}

/// Of all freedoms that the attempts of an advice lead to: most of a filter's time otherwise.
const std::array<double, 512>& log_factors() {
  static const std::array kFactors = [] {
    std::array<double, 512> factors{};
    for (std::size_t i = 1; i < factors.size(); ++i)
      factors[i] = log_factor(static_cast<double>(i));
    return factors;
  }();
  return kFactors;
}

/// Log density of Student's t distribution, without the scale. \param freedom  a whole number.
double log_student(double deviates, double freedom) {
  const auto whole = static_cast<std::size_t>(freedom);
  const double factor = whole < log_factors().size() ? log_factors()[whole] : log_factor(freedom);
  return factor - (freedom + 1) / 2 * std::log1p(deviates * deviates / freedom);
}

}  // namespace

DriftFilter::DriftFilter(Steps steps, double level)
    : steps_(steps),
      level_(level),
      ratio_(kPriorLogRatio),
      of_level_(kLevelVariance),
      of_ratio_(kPriorVariance / kPriorSpread),
      freedom_(kPriorFreedom),
      spread_(kPriorSpread) {}

void DriftFilter::add(const LogCost& cost) {
  of_level_ = std::min(of_level_ + steps_.level * steps_.level * cost.gap, kMaxLevelVariance);
  const double wandered = steps_.ratio * steps_.ratio * cost.gap;
  of_ratio_ = std::max(of_ratio_, std::min(of_ratio_ + wandered, kMaxRatioVariance));

  const double with_level = of_level_ + cost.effect * of_both_;
  const double with_ratio = of_both_ + cost.effect * of_ratio_;
  const double foretold = with_level + cost.effect * with_ratio + 1 / cost.weight;
  const double deviation = std::sqrt(foretold * spread_);
  const double seen =
      std::clamp((cost.value - level_ - cost.effect * ratio_) / deviation, -kBound, kBound);
  double moved = seen, known = 1;
  if (cost.is_censored) {
    moved = mean_above(seen);
    known = std::clamp(moved * (moved - seen), 0.0, 1.0);
    log_likelihood_ += std::log(upper_tail(seen));
  } else {
    log_likelihood_ += log_student(seen, freedom_) - std::log(deviation);
  }
  level_ += with_level / foretold * deviation * moved;
  ratio_ += with_ratio / foretold * deviation * moved;
  of_level_ -= with_level * with_level / foretold * known;
  of_both_ -= with_level * with_ratio / foretold * known;
  of_ratio_ -= with_ratio * with_ratio / foretold * known;
  if (!cost.is_censored) {
    spread_ *= (freedom_ + seen * seen) / (freedom_ + 1);
    ++freedom_;
  }
}

double DriftFilter::variance() const { return of_ratio_ * spread_ * freedom_ / (freedom_ - 2); }

}  // namespace kinship::evidence
