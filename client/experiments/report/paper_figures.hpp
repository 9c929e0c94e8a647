#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace kinship::experiments {

/// What the paper has for one robot and one guidance.
/// Source: Lehner, Roa and Albu-Schaeffer, Kinematic Transfer Learning of Sampling Distributions
/// for Manipulator Motion Planning (ICRA 2022), tables 1 and 2.
struct PaperCell {
  double time_s = 0, time_deviation_s = 0;
  double checks = 0, checks_deviation = 0;
  double length_deg = 0, length_deviation_deg = 0;
};

/// A table of the paper under the names of our robots.
struct PaperTable {
  std::vector<std::string_view> robots;
  std::vector<PaperCell> cells;  ///< guidance by guidance (uniform first), robot by robot

  /// \param guidance  "uniform" or the robot whose experience was used.
  std::optional<PaperCell> find(std::string_view robot, std::string_view guidance) const;
};

/// \param study  its name; a table without robots if the paper has none like it.
const PaperTable& paper_table(std::string_view study);

}  // namespace kinship::experiments
