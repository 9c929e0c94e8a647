#include "client/experiments/comparison_table.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include "client/experiments/formatted.hpp"
#include "client/page/json_text.hpp"
#include "proto/types/duration_text.hpp"

namespace kinship::experiments {
namespace {

/// \param width  in characters; of UTF-8, a text's bytes that begin one.
std::string padded(const std::string& text, std::size_t width) {
  const auto characters = static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
  return std::string(width > characters ? width - characters : 0, ' ') + text;
}

/// 12345 as "12 345", a half as one more (the page does); what is infinite as "unsolved".
std::string count_text(double value) {
  if (!std::isfinite(value))
    return "unsolved";
  std::string digits = formatted("%.0f", std::round(value));
  constexpr std::size_t kGroup = 3;
  for (std::size_t i = digits.size(); i > kGroup; i -= kGroup)
    digits.insert(i - kGroup, " ");
  return digits;
}

std::string seconds_text(double value) {
  return std::isfinite(value) ? duration_text(value) : "unsolved";
}

/// Uniform / guided; both unsolved says nothing.
std::string ratio_text(double ratio) {
  if (std::isnan(ratio))
    return "-";
  return std::isinf(ratio) ? "inf" : formatted("%.2f", ratio);
}

std::string p_text(double p) { return formatted(p < 1e-3 ? "%.1e" : "%.4f", p); }

void write_row(std::ostream& out, const ComparisonRow& row) {
  constexpr std::size_t kName = 26;
  constexpr std::size_t kColumn = 11;
  out << "  " << row.name << std::string(kName - std::min(kName, row.name.size()), ' ')
      << padded(row.uniform, kColumn) << padded(row.guided, kColumn);
  if (!row.ratio.empty())
    out << padded(row.ratio, kColumn - 2);
  if (!row.p.empty())
    out << padded(row.p, kColumn);
  out << '\n';
}

void write_row(std::ostream& out, const AlsoRow& row) {
  constexpr std::size_t kName = 20;
  constexpr std::size_t kColumn = 11;
  out << "  " << row.name << std::string(kName - std::min(kName, row.name.size()), ' ');
  for (const std::string& cell : {row.solved, row.checks, row.checks_ratio})
    out << padded(cell, kColumn - 2);
  out << padded(row.time, kColumn) << padded(row.time_ratio, kColumn - 2) << '\n';
}

std::string method_text(const WilcoxonSummary& test) {
  const std::string how = test.method == WilcoxonMethod::Exact
                              ? "exact"
                              : "normal approximation, corrected for ties and continuity";
  return how + ", " + std::to_string(test.pairs) + " pairs that differ";
}

std::string solved_text(const PlannerStatistics& planner, std::size_t pairs) {
  return std::to_string(planner.solved) + "/" + std::to_string(pairs);
}

/// A JSON number, or null for what JSON cannot say.
std::string json_number(double value) {
  return std::isfinite(value) ? formatted("%.12g", value) : "null";
}

std::string json_of(const PlannerStatistics& planner) {
  return "{\"solved\":" + std::to_string(planner.solved) +
         ",\"with_guidance\":" + std::to_string(planner.with_guidance) +
         ",\"mean_checks\":" + json_number(planner.mean_checks) +
         ",\"median_checks\":" + json_number(planner.median_checks) +
         ",\"mean_time_s\":" + json_number(planner.mean_time_s) +
         ",\"median_time_s\":" + json_number(planner.median_time_s) + "}";
}

/// {"start_collides": 3}; an empty object if all was planned.
std::string json_of(const guided::UnplannedProblems& unplanned) {
  std::string members;
  for (const auto& [reason, count] : unplanned.by_reason())
    members += (members.empty() ? "\"" : ",\"") + std::string(to_text(reason)) +
               "\":" + std::to_string(count);
  return "{" + members + "}";
}

std::string ratios_of(const Comparison& comparison) {
  return "{\"mean_checks\":" + json_number(comparison.mean_checks_ratio) +
         ",\"median_checks\":" + json_number(comparison.median_checks_ratio) +
         ",\"mean_time\":" + json_number(comparison.mean_time_ratio) +
         ",\"median_time\":" + json_number(comparison.median_time_ratio) + "}";
}

std::string json_of(const std::vector<AlsoCompared>& also) {
  std::string members;
  for (const AlsoCompared& each : also)
    members += (members.empty() ? "" : ",") +
               ("{\"name\":" + page::json_string(each.name) +
                ",\"pairs\":" + std::to_string(each.comparison.pairs) +
                ",\"uniform\":" + json_of(each.comparison.uniform) + ",\"guided\":" +
                json_of(each.comparison.guided) + ",\"ratio\":" + ratios_of(each.comparison) + "}");
  return "[" + members + "]";
}

std::string json_of(const WilcoxonSummary& test) {
  const bool exact = test.method == WilcoxonMethod::Exact;
  return "{\"p\":" + json_number(test.p) + ",\"pairs\":" + std::to_string(test.pairs) +
         ",\"dropped\":" + std::to_string(test.dropped) +
         ",\"rank_sum_plus\":" + json_number(test.rank_sum_plus) +
         ",\"rank_sum_minus\":" + json_number(test.rank_sum_minus) + ",\"method\":\"" +
         (exact ? "exact" : "normal_approximation") + "\"}";
}

}  // namespace

std::vector<ComparisonRow> comparison_rows(const Comparison& comparison) {
  const PlannerStatistics& u = comparison.uniform;
  const PlannerStatistics& g = comparison.guided;
  std::vector<ComparisonRow> rows = {
      {"solved", solved_text(u, comparison.pairs), solved_text(g, comparison.pairs), "", ""},
      {"collision checks, mean", count_text(u.mean_checks), count_text(g.mean_checks),
       ratio_text(comparison.mean_checks_ratio), p_text(comparison.checks_test.p)},
      {"collision checks, median", count_text(u.median_checks), count_text(g.median_checks),
       ratio_text(comparison.median_checks_ratio), ""},
      {"planning time, mean", seconds_text(u.mean_time_s), seconds_text(g.mean_time_s),
       ratio_text(comparison.mean_time_ratio), p_text(comparison.time_test.p)},
      {"planning time, median", seconds_text(u.median_time_s), seconds_text(g.median_time_s),
       ratio_text(comparison.median_time_ratio), ""}};
  return rows;
}

std::vector<std::string> comparison_notes(const Comparison& comparison) {
  const PlannerStatistics& u = comparison.uniform;
  const PlannerStatistics& g = comparison.guided;
  std::vector<std::string> notes = {
      "ratio: uniform / guided. p: two-sided Wilcoxon signed-rank test, unsolved ranked worst (" +
      method_text(comparison.checks_test) + ")."};
  if (u.solved < comparison.pairs || g.solved < comparison.pairs)
    notes.emplace_back(
        "An unsolved attempt counts in a mean with what it had used when it gave up: that mean "
        "is a lower bound. In a median it is worse than all that are solved.");
  if (g.with_guidance < comparison.pairs)
    notes.push_back("Only " + std::to_string(g.with_guidance) + " of the " +
                    std::to_string(comparison.pairs) +
                    " guided attempts drew from a distribution.");
  if (u.with_guidance > 0)
    notes.push_back(std::to_string(u.with_guidance) +
                    " of the uniform attempts drew from a distribution.");
  if (comparison.proven_by_one > 0)
    notes.push_back("Of " + std::to_string(comparison.proven_by_one) +
                    " pairs of paths one is proven and the other is not (--resolution): they are "
                    "not asked the same, in checks or in time.");
  if (!comparison.unpaired.empty())
    notes.push_back(std::to_string(comparison.unpaired.size()) +
                    " problems were answered by one side only and left out.");
  if (comparison.unplanned.size() > 0)
    notes.push_back(std::to_string(comparison.unplanned.size()) +
                    " problems could not be planned and are left out (" +
                    comparison.unplanned.reasons() + ").");
  return notes;
}

std::vector<AlsoRow> also_rows(const std::vector<AlsoCompared>& also) {
  std::vector<AlsoRow> rows;
  for (const auto& [name, comparison] : also)
    rows.push_back(
        {name, solved_text(comparison.guided, comparison.pairs),
         count_text(comparison.guided.mean_checks), ratio_text(comparison.mean_checks_ratio),
         seconds_text(comparison.guided.mean_time_s), ratio_text(comparison.mean_time_ratio)});
  return rows;
}

void write_table(const Comparison& comparison, const std::vector<AlsoCompared>& also,
                 std::ostream& out) {
  out << comparison.pairs << " problems, each planned with both\n\n";
  write_row(out, ComparisonRow{"", "uniform", "guided", "ratio", "p"});
  for (const ComparisonRow& row : comparison_rows(comparison))
    write_row(out, row);
  out << '\n';
  for (const std::string& note : comparison_notes(comparison))
    out << note << '\n';
  comparison.unplanned.write_first(out);
  if (also.empty())
    return;
  out << "\nThe same problems, means and the ratio of uniform planning to each:\n\n";
  write_row(out, AlsoRow{"", "solved", "checks", "ratio", "time", "ratio"});
  for (const AlsoRow& row : also_rows(also))
    write_row(out, row);
}

void write_json(const Comparison& comparison, const std::vector<AlsoCompared>& also,
                std::ostream& out) {
  out << "{\"pairs\":" << comparison.pairs << ",\"uniform\":" << json_of(comparison.uniform)
      << ",\"guided\":" << json_of(comparison.guided) << ",\"ratio\":" << ratios_of(comparison)
      << ",\"wilcoxon_checks\":" << json_of(comparison.checks_test)
      << ",\"wilcoxon_time\":" << json_of(comparison.time_test)
      << ",\"unpaired\":" << comparison.unpaired.size()
      << ",\"not_planned\":" << json_of(comparison.unplanned);
  if (!also.empty())
    out << ",\"also\":" << json_of(also);
  out << "}\n";
}

}  // namespace kinship::experiments
