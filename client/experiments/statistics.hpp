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

}  // namespace kinship::experiments
