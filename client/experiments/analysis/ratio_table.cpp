#include "client/experiments/analysis/ratio_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <ostream>

#include "client/experiments/analysis/cell_statistics.hpp"
#include "client/experiments/formatted.hpp"

namespace kinship::experiments {
namespace {

using Pairs = std::vector<std::pair<const CellResults*, const CellResults*>>;

void write_mean(const char* what, const Pairs& pairs, double least, std::ostream& out) {
  if (pairs.empty())
    return;
  const GeometricMean checks = geometric_mean_ratio(pairs, Quantity::Checks);
  const GeometricMean cpu = geometric_mean_ratio(pairs, Quantity::Cpu);
  out << formatted("%-12s checks %.2f [%.2f, %.2f], least %.2f, time %.2f, %zu pairs\n", what,
                   checks.value, checks.low, checks.high, least, cpu.value, pairs.size());
}

}  // namespace

std::string uniform_name(double overshoot) {
  return overshoot == 1 ? "uniform" : formatted("uniform f%g", overshoot);
}

void write_ratio_table(const RatioTable& table, const std::vector<QueryResult>& results,
                       std::ostream& out) {
  std::map<std::string, CellResults> uniform;
  std::vector<CellResults> guided;
  guided.reserve(table.pairs.size());  // pointers into it are kept
  Pairs own, transferred;
  double least_own = INFINITY, least_transferred = INFINITY;
  out << formatted("%-14s %-14s %9s %9s %9s %7s  %-14s %6s %6s %8s %9s\n", "robot", "experience",
                   "uniform", "f = 1", "guided", "ratio", "95 %", "median", "time", "p", "solved");
  for (const TablePair& pair : table.pairs) {
    for (const double overshoot : {1.0, table.overshoot}) {
      const std::string name = uniform_name(overshoot);
      uniform.try_emplace(pair.robot + " " + name,
                          collect_cell(results, pair.robot, name, table.max_checks));
    }
    const CellResults& plain = uniform.at(pair.robot + " " + uniform_name(1));
    const CellResults& base = uniform.at(pair.robot + " " + uniform_name(table.overshoot));
    guided.push_back(collect_cell(results, pair.robot, pair.cell, table.max_checks));
    const CellResults& cell = guided.back();
    const PairRatio ratio = compare_cells(base, cell);
    out << formatted(
        "%-14s %-14s %9.0f %9.0f %9.0f %7.2f  [%.2f, %.2f]   %6.2f %6.2f %8.1g %4zu/%zu\n",
        pair.robot.c_str(), pair.source.c_str(), moments_of(flat(base.checks)).mean,
        moments_of(flat(plain.checks)).mean, moments_of(flat(cell.checks)).mean, ratio.checks_ratio,
        ratio.low, ratio.high, ratio.median_checks_ratio, ratio.cpu_ratio, ratio.checks_test.p,
        cell.solved_queries(), cell.queries());
    (pair.is_own ? own : transferred).emplace_back(&base, &cell);
    double& least = pair.is_own ? least_own : least_transferred;
    least = std::min(least, ratio.checks_ratio);
  }
  write_mean("own", own, least_own, out);
  write_mean("transferred", transferred, least_transferred, out);
}

void write_calibration(const Study& study, const std::vector<QueryResult>& results,
                       std::ostream& out) {
  double sum = 0, paper_sum = 0;
  for (const StudyRobot& robot : study.robots) {
    const CellResults cell =
        collect_cell(results, robot.model, uniform_name(1), study.settings.max_checks);
    const Moments checks = moments_of(flat(cell.checks));
    sum += checks.mean;
    paper_sum += robot.paper_checks;
    out << formatted("%-14s checks %.0f (deviation %.0f, median %.0f), paper %.0f: %.2f of it; ",
                     robot.model.c_str(), checks.mean, checks.deviation, checks.median,
                     robot.paper_checks, checks.mean / robot.paper_checks)
        << cell.solved_queries() << " of " << cell.queries() << " solved\n";
  }
  out << formatted("mean over the robots: %.0f, paper %.0f: %.2f of it\n",
                   sum / static_cast<double>(study.robots.size()),
                   paper_sum / static_cast<double>(study.robots.size()), sum / paper_sum);
}

}  // namespace kinship::experiments
