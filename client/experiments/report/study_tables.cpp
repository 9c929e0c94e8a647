#include "client/experiments/report/study_tables.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include "client/experiments/analysis/ratio_table.hpp"
#include "client/experiments/formatted.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::experiments {
namespace {

constexpr const char* kNothing = "\u2013";
constexpr double kDegrees = 180 / std::numbers::pi;

/// One of the paper's quantities: ours of a cell, the paper's, and how a number is written.
struct Column {
  const char* caption;
  const char* format;
  std::function<std::vector<double>(const CellResults&)> ours;
  double PaperCell::*mean;
  double PaperCell::*deviation;
};

std::vector<double> in_degrees(const CellResults& cell) {
  std::vector<double> lengths = flat(cell.lengths);
  for (double& length : lengths)
    length *= kDegrees;
  return lengths;
}

std::vector<Column> columns() {
  return {{"Collision checks to the first path: mean ± deviation, median; in brackets the paper's",
           "%.0f", [](const CellResults& cell) { return flat(cell.checks); }, &PaperCell::checks,
           &PaperCell::checks_deviation},
          {"Planning time, s of one thread: mean ± deviation, median; in brackets the paper's",
           "%.3g", [](const CellResults& cell) { return flat(cell.cpu_s); }, &PaperCell::time_s,
           &PaperCell::time_deviation_s},
          {"Path length, degrees in joint space: mean ± deviation, median; in brackets the paper's",
           "%.0f", in_degrees, &PaperCell::length_deg, &PaperCell::length_deviation_deg}};
}

std::string moments_text(const Column& column, const std::vector<double>& values) {
  if (values.empty())
    return kNothing;
  const Moments moments = moments_of(values);
  const std::string format =
      std::string(column.format) + " \u00b1 " + column.format + ", " + column.format;
  return formatted(format.c_str(), moments.mean, moments.deviation, moments.median);
}

std::string paper_text(const Column& column, const std::optional<PaperCell>& cell) {
  if (!cell)
    return "";
  const std::string format = std::string(" (") + column.format + " \u00b1 " + column.format + ")";
  return formatted(format.c_str(), (*cell).*column.mean, (*cell).*column.deviation);
}

html::Table cell_table(const StudyResults& results, const PaperTable& paper, const Column& column) {
  html::Table table{column.caption, {"guidance"}, {}};
  for (const std::string& robot : results.robots())
    table.head.push_back(robot);
  std::vector<std::string> guidances = {uniform_name(1)};
  if (results.uniform() != uniform_name(1))
    guidances.push_back(results.uniform());
  guidances.insert(guidances.end(), results.robots().begin(), results.robots().end());
  for (const std::string& guidance : guidances) {
    std::vector<std::string> row = {guidance};
    for (const std::string& robot : results.robots()) {
      const CellResults* const cell = results.find(robot, guidance);
      row.push_back((cell == nullptr ? kNothing : moments_text(column, column.ours(*cell))) +
                    paper_text(column, paper.find(robot, guidance)));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string p_text(double p) { return formatted(p < 0.001 ? "%.1e" : "%.3f", p); }

std::string mean_text(const GeometricMean& mean) {
  if (mean.pairs == 0)
    return kNothing;
  return formatted("%.2f [%.2f, %.2f]", mean.value, mean.low, mean.high);
}

/// Of the distribution that a pair was guided by; null if it is not among them.
const Source* find_source(const std::vector<Distribution>& distributions,
                          const std::map<Digest, std::string>& labels, const PairRatio& pair) {
  for (const Distribution& distribution : distributions) {
    const auto target = labels.find(distribution.robot);
    if (target != labels.end() && target->second == pair.robot &&
        distribution.sources.size() == 1 && distribution.sources[0].label == pair.guidance)
      return &distribution.sources[0];
  }
  return nullptr;
}

std::string percent_text(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0)
    return kNothing;
  return formatted("%.0f %%", 100 * static_cast<double>(part) / static_cast<double>(whole));
}

/// What a transfer left of a source: poses solved, tracks kept a path, configurations found at
/// random, configurations that a filter left out.
std::vector<std::string> remains_of(const Source& source) {
  const double paths = static_cast<double>(std::max<std::uint64_t>(source.paths_used, 1));
  return {percent_text(source.poses_solved, source.poses),
          formatted("%.2f", static_cast<double>(source.tracks_kept) / paths),
          percent_text(source.random_configurations, source.configurations),
          percent_text(source.self_collisions + source.scene_collisions, source.filter_checks)};
}

double least_ratio(const StudyResults& results, bool own) {
  double least = INFINITY;
  for (const std::string& robot : results.robots())
    for (const std::string& source : results.robots())
      if (const PairRatio* const pair = results.find_pair(robot, source);
          pair != nullptr && (robot == source) == own)
        least = std::min(least, pair->checks_ratio);
  return least;
}

}  // namespace

std::vector<html::Table> cell_tables(const StudyResults& results, const PaperTable& paper) {
  std::vector<html::Table> tables;
  for (const Column& column : columns())
    tables.push_back(cell_table(results, paper, column));
  return tables;
}

html::Table pair_table(const StudyResults& results) {
  html::Table table{
      "Uniform against guided with the same planner options. Ratio of mean checks with its 95 % "
      "interval (instances resampled); Wilcoxon over instance means; McNemar over queries.",
      {"robot", "experience of", "ratio", "95 %", "to the better uniform", "of medians", "of times",
       "p, checks", "p, time", "solved uniform", "solved guided", "p, success"},
      {}};
  for (const std::string& robot : results.robots())
    for (const std::string& source : results.robots()) {
      const PairRatio* const pair = results.find_pair(robot, source);
      if (pair == nullptr)
        continue;
      const CellResults& uniform = *results.find(robot, results.uniform());
      const CellResults& guided = *results.find(robot, source);
      const auto solved = [](const CellResults& cell) {
        return formatted("%zu/%zu", cell.solved_queries(), cell.queries());
      };
      table.rows.push_back(
          {robot, source + (robot == source ? " (own)" : ""), formatted("%.2f", pair->checks_ratio),
           formatted("[%.2f, %.2f]", pair->low, pair->high),
           formatted("%.2f", results.ratio_to_better_uniform(robot, source)),
           formatted("%.2f", pair->median_checks_ratio), formatted("%.2f", pair->cpu_ratio),
           p_text(pair->checks_test.p), p_text(pair->cpu_test.p), solved(uniform), solved(guided),
           p_text(pair->success_p)});
    }
  return table;
}

html::Table summary_table(const StudyResults& results) {
  using Pairs = StudyResults::Pairs;
  const auto row = [&](const char* what, Pairs pairs, const std::string& least) {
    const GeometricMean checks = results.geometric_mean(pairs, Quantity::Checks);
    return std::vector<std::string>{what, std::to_string(checks.pairs), mean_text(checks), least,
                                    mean_text(results.geometric_mean(pairs, Quantity::Cpu))};
  };
  return {
      "Geometric means of the ratios over pairs, with 95 % intervals",
      {"experience", "pairs", "checks", "least", "time"},
      {row("own", Pairs::Own, formatted("%.2f", least_ratio(results, true))),
       row("of another robot", Pairs::Transferred, formatted("%.2f", least_ratio(results, false))),
       row("all", Pairs::All, "")}};
}

html::Table variant_table(const std::string& caption,
                          const std::vector<std::pair<std::string, VariantCells>>& variants) {
  html::Table table{"Side study: " + caption,
                    {"variant", "robot", "experience of", "uniform", "variant", "median", "solved",
                     "ratio", "95 %", "of times"},
                    {}};
  for (const auto& [variant, cells] : variants) {
    std::vector<std::pair<const CellResults*, const CellResults*>> own, others;
    for (const VariantCell& cell : cells) {
      const PairRatio pair = compare_cells(*cell.uniform, cell.guided);
      const Moments checks = moments_of(flat(cell.guided.checks));
      table.rows.push_back(
          {variant, pair.robot, pair.guidance.substr(0, pair.guidance.find('|')),
           formatted("%.0f", moments_of(flat(cell.uniform->checks)).mean),
           formatted("%.0f", checks.mean), formatted("%.0f", checks.median),
           formatted("%zu/%zu", cell.guided.solved_queries(), cell.guided.queries()),
           formatted("%.2f", pair.checks_ratio), formatted("[%.2f, %.2f]", pair.low, pair.high),
           formatted("%.2f", pair.cpu_ratio)});
      (cell.is_own ? own : others).emplace_back(cell.uniform, &cell.guided);
    }
    for (const auto& [what, pairs] : {std::pair("own", &own), std::pair("not only own", &others)})
      if (!pairs->empty())
        table.rows.push_back({variant, "geometric mean", what, "", "", "", "", "",
                              mean_text(geometric_mean_ratio(*pairs, Quantity::Checks)),
                              mean_text(geometric_mean_ratio(*pairs, Quantity::Cpu))});
  }
  return table;
}

html::Table worst_source_table(const StudyResults& results,
                               const std::vector<Distribution>& distributions,
                               const std::map<Digest, std::string>& labels) {
  html::Table table{
      "Where transfer lost: for each robot the source that helped least, and the best other one",
      {"robot", "experience of", "ratio", "of medians", "poses solved", "tracks kept a path",
       "at random", "filtered"},
      {}};
  for (const std::string& robot : results.robots()) {
    std::vector<const PairRatio*> pairs;
    for (const std::string& source : results.robots())
      if (const PairRatio* const pair = results.find_pair(robot, source);
          pair != nullptr && robot != source)
        pairs.push_back(pair);
    if (pairs.empty())
      continue;
    const auto [worst, best] = std::ranges::minmax_element(pairs, {}, &PairRatio::checks_ratio);
    for (const auto& [what, pair] : {std::pair("least", *worst), std::pair("most", *best)}) {
      std::vector<std::string> row = {robot, pair->guidance + " (" + what + ")",
                                      formatted("%.2f", pair->checks_ratio),
                                      formatted("%.2f", pair->median_checks_ratio)};
      if (const Source* const source = find_source(distributions, labels, *pair))
        for (std::string& cell : remains_of(*source))
          row.push_back(std::move(cell));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

html::Table distribution_table(const std::vector<Distribution>& distributions,
                               const std::map<Digest, std::string>& labels) {
  html::Table table{
      "What the server made of the learning sets",
      {"for", "experience of", "paths", "poses", "poses solved", "tracks kept", "at random",
       "filtered", "configurations", "components", "transfer, s", "fit, s", "state"},
      {}};
  for (const Distribution& distribution : distributions) {
    const auto known = labels.find(distribution.robot);
    const std::string target =
        known == labels.end() ? distribution.robot.short_hex() : known->second;
    for (const Source& source : distribution.sources)
      table.rows.push_back(
          {target, source.label, std::to_string(source.paths_used), std::to_string(source.poses),
           std::to_string(source.poses_solved), std::to_string(source.tracks_kept),
           std::to_string(source.random_configurations),
           std::to_string(source.self_collisions + source.scene_collisions),
           std::to_string(source.configurations),
           distribution.mixture ? std::to_string(distribution.mixture->size()) : kNothing,
           formatted("%.2f", distribution.transfer_time_s),
           formatted("%.2f", distribution.fit_time_s), std::string(to_text(distribution.state))});
  }
  return table;
}

}  // namespace kinship::experiments
