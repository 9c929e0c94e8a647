#include "client/experiments/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

namespace kinship::experiments {

double mean(const std::vector<double>& values) {
  if (values.empty())
    throw std::invalid_argument("mean: no values");
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double median(std::vector<double> values) {
  if (values.empty())
    throw std::invalid_argument("median: no values");
  if (std::ranges::any_of(values, [](double value) { return std::isnan(value); }))
    throw std::invalid_argument("median: a value is not a number");
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  if (values.size() % 2 == 1)
    return values[middle];
  return (values[middle - 1] + values[middle]) / 2;
}

MeanInterval mean_interval(const std::vector<double>& values) {
  constexpr std::size_t kResamples = 10'000;
  constexpr double kTail = 0.025;
  MeanInterval interval;
  interval.mean = mean(values);
  std::mt19937_64 generator(1);
  std::uniform_int_distribution<std::size_t> any(0, values.size() - 1);
  std::vector<double> means(kResamples);
  for (double& each : means) {
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      sum += values[any(generator)];
    each = sum / static_cast<double>(values.size());
  }
  std::ranges::sort(means);
  const auto tail = static_cast<std::size_t>(kTail * static_cast<double>(kResamples));
  interval.low = means[tail];
  interval.high = means[kResamples - 1 - tail];
  return interval;
}

}  // namespace kinship::experiments
