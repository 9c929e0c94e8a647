#pragma once

#include <vector>

#include "client/experiments/analysis/study_results.hpp"
#include "client/experiments/report/html.hpp"
#include "client/experiments/report/paper_figures.hpp"
#include "proto/types/distribution.hpp"

/// The tables of a report.
namespace kinship::experiments {

/// Like the paper's Table 1 and 2: a row per guidance, a column per robot, our figures and the
/// paper's; one table each for time, checks and path length.
std::vector<html::Table> cell_tables(const StudyResults& results, const PaperTable& paper);

/// A row per pair: ratios, intervals, tests, success.
html::Table pair_table(const StudyResults& results);

/// Geometric means over own and over transferred experience.
html::Table summary_table(const StudyResults& results);

/// A cell of a variant, and the uniform one that it is compared with.
struct VariantCell {
  CellResults guided;
  const CellResults* uniform = nullptr;
  bool is_own = false;  ///< guided by the robot's own experience alone
};
using VariantCells = std::vector<VariantCell>;

/// A row per cell of each variant, then its geometric means.
html::Table variant_table(const std::string& caption,
                          const std::vector<std::pair<std::string, VariantCells>>& variants);

/// For each robot the source that helped it least, beside its own experience and the best other
/// source: what it was worth and what was left of its paths.
html::Table worst_source_table(const StudyResults& results,
                               const std::vector<Distribution>& distributions,
                               const std::map<Digest, std::string>& labels);

/// What the server made of each source for each target, and how long it took.
/// \param labels  of the robots by digest.
html::Table distribution_table(const std::vector<Distribution>& distributions,
                               const std::map<Digest, std::string>& labels);

}  // namespace kinship::experiments
