#pragma once

#include <string>
#include <vector>

namespace kinship::experiments {

/// A bar with the 95 % interval of what it shows.
struct Bar {
  std::string series;
  double value = 0, low = 0, high = 0;
};

/// Bars that stand together: one robot, one bar per guidance.
struct BarGroup {
  std::string label;
  std::vector<Bar> bars;
};

/// A bar figure as an SVG document, with a legend of the series in the order of the first group.
/// \param unit  of the values, at the axis.
std::string bar_figure(const std::vector<BarGroup>& groups, const std::string& unit);

}  // namespace kinship::experiments
