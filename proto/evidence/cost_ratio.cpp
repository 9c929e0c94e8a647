#include "proto/evidence/cost_ratio.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "proto/evidence/drift_filter.hpp"

namespace kinship::evidence {
namespace {

constexpr double kBoundOfAll = 3.5;            // robust standard deviations from the median
constexpr double kMinDeviation = 0.7;          // of log(cost)
constexpr double kDeviationOfMedian = 1.4826;  // standard deviations in a median absolute deviation

/// One answer to how fast level and ratio wander, and how likely it is beforehand.
struct Hypothesis {
  DriftFilter::Steps steps;
  double prior;
};

constexpr std::array kHypotheses = {Hypothesis{{0, 0}, 0.6},       Hypothesis{{0.15, 0}, 0.16},
                                    Hypothesis{{0.5, 0}, 0.04},    Hypothesis{{0, 0.3}, 0.15},
                                    Hypothesis{{0.15, 0.3}, 0.04}, Hypothesis{{0.5, 0.3}, 0.01}};

double upper_tail_of(double deviates) { return std::erfc(deviates / std::numbers::sqrt2) / 2; }

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Whether times are known well enough to be compared, see compare_costs().
bool compares_times(std::span<const JudgedAttempt> recent) {
  return std::ranges::all_of(std::array{SamplingMode::Guided, SamplingMode::Control},
                             [&](auto mode) {
                               std::size_t timed = 0, untimed = 0;
                               for (const JudgedAttempt& attempt : recent)
                                 if (attempt.sampling_mode == mode) {
                                   timed += attempt.time_s > 0 ? 1 : 0;
                                   untimed += attempt.time_s == 0 && attempt.checks > 0 ? 1 : 0;
                                 }
                               return timed > 0 && (untimed == 0 || timed >= kMinTimed);
                             });
}

/// The attempts that report their cost: processor time, or checks.
std::vector<LogCost> log_costs(std::span<const JudgedAttempt> recent, bool is_by_time) {
  std::vector<LogCost> costs;
  double last_age = 0;
  for (const JudgedAttempt& attempt : recent) {
    const double cost = is_by_time ? attempt.time_s : static_cast<double>(attempt.checks);
    if (cost <= 0)
      continue;
    const auto age = static_cast<double>(attempt.age);
    costs.push_back({.value = std::log(cost),
                     .effect = attempt.sampling_mode == SamplingMode::Guided ? -0.5 : 0.5,
                     .is_censored = !attempt.solved,
                     .gap = costs.empty() ? 0 : std::max(0.0, last_age - age),
                     .weight = std::max(std::exp2(-age / kHalfLife), 1e-9)});
    last_age = age;
  }
  return costs;
}

/// Brings costs far from all others to the edge. \return the median.
double bound(std::vector<LogCost>& costs) {
  std::vector<double> values;
  for (const LogCost& cost : costs)
    values.push_back(cost.value);
  const double middle = median(values);
  for (double& value : values)
    value = std::abs(value - middle);
  const double reach =
      kBoundOfAll * std::max(kMinDeviation, kDeviationOfMedian * median(std::move(values)));
  for (LogCost& cost : costs)
    cost.value = std::clamp(cost.value, middle - reach, middle + reach);
  return middle;
}

/// The beliefs of all hypotheses, each as likely as the attempts make it.
CostRatio average(const std::vector<LogCost>& costs, double level) {
  std::array<double, kHypotheses.size()> weights{};
  std::vector<DriftFilter> filters;
  for (std::size_t i = 0; i < kHypotheses.size(); ++i) {
    filters.emplace_back(kHypotheses[i].steps, level);
    for (const LogCost& cost : costs)
      filters.back().add(cost);
    weights[i] = std::log(kHypotheses[i].prior) + filters.back().log_likelihood();
  }
  const double greatest = *std::max_element(weights.begin(), weights.end());
  double sum = 0;
  for (double& weight : weights)
    sum += weight = std::exp(weight - greatest);
  CostRatio ratio{.mean = 0, .variance = 0, .guided_is_cheaper = 0, .is_compared = true};
  for (std::size_t i = 0; i < filters.size(); ++i) {
    const double mean = filters[i].ratio(), variance = filters[i].variance();
    ratio.mean += weights[i] / sum * mean;
    ratio.variance += weights[i] / sum * (variance + mean * mean);
    ratio.guided_is_cheaper += weights[i] / sum * upper_tail_of(-mean / std::sqrt(variance));
  }
  ratio.variance -= ratio.mean * ratio.mean;
  return ratio;
}

}  // namespace

double CostRatio::quantile(double deviates) const {
  return std::exp(mean + deviates * std::sqrt(variance));
}

CostRatio compare_costs(std::span<const JudgedAttempt> recent) {
  const bool is_by_time = compares_times(recent);
  std::vector<LogCost> costs = log_costs(recent, is_by_time);
  const auto is_guided = [](const LogCost& cost) { return cost.effect < 0; };
  const auto guided = std::count_if(costs.begin(), costs.end(), is_guided);
  if (guided == 0 || guided == static_cast<std::ptrdiff_t>(costs.size()))
    return {kPriorLogRatio, kPriorVariance,
            upper_tail_of(-kPriorLogRatio / std::sqrt(kPriorVariance))};
  const double level = bound(costs);
  CostRatio ratio = average(costs, level);
  ratio.is_by_time = is_by_time;
  return ratio;
}

}  // namespace kinship::evidence
