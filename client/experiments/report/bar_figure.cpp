#include "client/experiments/report/bar_figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "client/experiments/formatted.hpp"
#include "client/experiments/report/html.hpp"

namespace kinship::experiments {
namespace {

// In pixels.
constexpr double kBarWidth = 18, kBarGap = 3, kGroupGap = 34;
constexpr double kLeft = 70, kTop = 30, kPlotHeight = 260, kBottom = 60;
constexpr double kLegendEntry = 130;

constexpr std::array<const char*, 7> kColours = {"#8a97a5", "#0072b2", "#d55e00", "#009e73",
                                                 "#cc79a7", "#e69f00", "#56b4e9"};

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return formatted("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor) +
         html::escaped(text) + "</text>\n";
}

/// The least of 1, 2, 5, 10, 20, ... of which at most six cover the highest value.
double tick_of(double highest) {
  constexpr double kTicks = 6;
  double power = std::pow(10, std::floor(std::log10(std::max(highest, 1e-9) / kTicks)));
  for (const double factor : {1.0, 2.0, 5.0, 10.0})
    if (highest <= kTicks * factor * power)
      return factor * power;
  return 10 * power;
}

double highest_of(const std::vector<BarGroup>& groups) {
  double highest = 0;
  for (const BarGroup& group : groups)
    for (const Bar& bar : group.bars)
      highest = std::max({highest, bar.value, bar.high});
  return highest;
}

double width_of(const BarGroup& group) {
  return static_cast<double>(group.bars.size()) * (kBarWidth + kBarGap) + kGroupGap;
}

/// Draws bars up to a highest value.
class Plot {
 public:
  explicit Plot(double highest) : tick_(tick_of(highest)) {
    top_value_ = tick_ * std::ceil(highest / tick_);
  }

  std::string axis(double width, const std::string& unit) const {
    std::string svg;
    for (int i = 0; i * tick_ <= top_value_ * (1 + 1e-9); ++i) {
      const double value = i * tick_;
      svg +=
          formatted("<line x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"#e0e5ea\"/>\n",
                    kLeft, width, y_of(value), y_of(value));
      svg += text_at(kLeft - 6, y_of(value) + 4, "end", formatted("%g", value));
    }
    return svg + text_at(kLeft - 6, kTop - 12, "end", unit);
  }

  std::string bar(double x, const Bar& bar, const char* colour) const {
    std::string svg =
        formatted("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\"><title>",
                  x, y_of(bar.value), kBarWidth, y_of(0) - y_of(bar.value), colour);
    svg += html::escaped(bar.series) +
           formatted(": %.4g [%.4g, %.4g]</title></rect>\n", bar.value, bar.low, bar.high);
    if (bar.high > bar.low)
      svg +=
          formatted("<line x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"#1c2733\"/>\n",
                    x + kBarWidth / 2, x + kBarWidth / 2, y_of(bar.low), y_of(bar.high));
    return svg;
  }

 private:
  double y_of(double value) const { return kTop + kPlotHeight * (1 - value / top_value_); }

  double tick_ = 1;
  double top_value_ = 1;
};

std::string legend(const BarGroup& group) {
  std::string svg;
  double x = kLeft;
  const double y = kTop + kPlotHeight + kBottom - 14;
  for (std::size_t i = 0; i < group.bars.size(); ++i, x += kLegendEntry) {
    svg += formatted("<rect x=\"%.1f\" y=\"%.1f\" width=\"12\" height=\"12\" fill=\"%s\"/>\n", x,
                     y - 10, kColours[i % kColours.size()]);
    svg += text_at(x + 17, y, "start", group.bars[i].series);
  }
  return svg;
}

}  // namespace

std::string bar_figure(const std::vector<BarGroup>& groups, const std::string& unit) {
  if (groups.empty())
    return "";
  double width = kLeft;
  for (const BarGroup& group : groups)
    width += width_of(group);
  width = std::max(width, kLeft + kLegendEntry * static_cast<double>(groups[0].bars.size()));
  const double height = kTop + kPlotHeight + kBottom;
  const Plot plot(highest_of(groups));
  std::string svg = formatted(
                        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" "
                        "width=\"%.0f\" font-size=\"12\" font-family=\"sans-serif\">\n"
                        "<rect width=\"100%%\" height=\"100%%\" fill=\"#ffffff\"/>\n",
                        width, height, width) +
                    plot.axis(width, unit);
  double x = kLeft;
  for (const BarGroup& group : groups) {
    const double end = x + width_of(group);
    svg += text_at((x + end - kGroupGap) / 2 + kGroupGap / 4, kTop + kPlotHeight + 18, "middle",
                   group.label);
    x += kGroupGap / 2;
    for (std::size_t i = 0; i < group.bars.size(); ++i, x += kBarWidth + kBarGap)
      svg += plot.bar(x, group.bars[i], kColours[i % kColours.size()]);
    x = end;
  }
  return svg + legend(groups[0]) + "</svg>\n";
}

}  // namespace kinship::experiments
