#pragma once

#include <vector>

namespace kinship::experiments {

/// Arithmetic mean.
/// \throws std::invalid_argument if `values` is empty.
double mean(const std::vector<double>& values);

/// The middle value, or the mean of the two in the middle. Infinite values count as the largest, so
/// the median is infinite if half of the values are.
/// \throws std::invalid_argument if `values` is empty or holds a NaN.
double median(std::vector<double> values);

/// A mean and where it may lie.
struct MeanInterval {
  double mean = 0, low = 0, high = 0;
};

/// The mean with its 95 % interval by percentiles of the bootstrap (10 000 resamples, seeded: equal
/// values, equal interval). Checks of planners are skewed; this does not mind.
/// \throws std::invalid_argument if `values` is empty.
/// Source: Efron and Tibshirani, An Introduction to the Bootstrap (1993), section 13.3.
MeanInterval mean_interval(const std::vector<double>& values);

}  // namespace kinship::experiments
