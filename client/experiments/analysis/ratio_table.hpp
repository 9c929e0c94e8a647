#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "client/experiments/pipeline/query_result.hpp"
#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {

/// Name of a cell that plans uniformly.
std::string uniform_name(double overshoot);

/// A guided cell that is compared with uniform planning of its robot.
struct TablePair {
  std::string robot, source;  ///< labels
  std::string cell;           ///< the guided cell's name in the results
  bool is_own = false;        ///< the source is the robot itself
};

/// What is compared with what.
struct RatioTable {
  std::vector<TablePair> pairs;
  double overshoot = 1;  ///< of guided cells, and of the uniform ones they are compared with
  std::uint64_t max_checks = 0;
};

/// One line per pair, then the geometric means over own and over transferred experience.
void write_ratio_table(const RatioTable& table, const std::vector<QueryResult>& results,
                       std::ostream& out);

/// One line per robot: checks of uniform planning beside the paper's, and whether they are within
/// what was asked: a factor of two each, 25 % in the mean, 98 % solved.
void write_calibration(const Study& study, const std::vector<QueryResult>& results,
                       std::ostream& out);

}  // namespace kinship::experiments
