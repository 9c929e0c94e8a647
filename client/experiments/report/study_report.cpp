#include "client/experiments/report/study_report.hpp"

#include <cstdio>
#include <ctime>
#include <map>
#include <ostream>

#include "client/experiments/analysis/ratio_table.hpp"
#include "client/experiments/analysis/study_results.hpp"
#include "client/experiments/formatted.hpp"
#include "client/experiments/report/bar_figure.hpp"
#include "client/experiments/report/cloud_figure.hpp"
#include "client/experiments/report/html.hpp"
#include "client/experiments/report/study_tables.hpp"
#include "client/experiments/statistics.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

constexpr const char* kNoPeers =
    "There is no line of OMPL's own experience planners, Lightning and Thunder, along a "
    "constraint: "
    "recalled paths are joined to start and goal by straight lines in joint space, which do not "
    "keep to the tilt limit. A projected space in their hands was not tried.";

std::string protocol_text(const Study& study, const ReportData& data) {
  std::uint32_t seeds = 0;
  for (const QueryResult& result : data.test)
    seeds = std::max(seeds, result.key.seed + 1);
  return formatted(
      "%u learning instances per robot, planned uniformly with overshoot 1, solved or not, and "
      "reported to a kinshipd; %u test instances, %u queries each, planned uniformly and with the "
      "distributions that the server made of one robot's experience. Step %g, overshoot %g, guided "
      "samples %g of all; a query ends at its first path or at %llu checks, which an unsolved one "
      "counts. Ratios are means of uniform planning by means of guided planning.",
      study.learning_instances, study.test_instances, seeds, study.settings.resolution,
      study.settings.overshoot, study.guided_share,
      static_cast<unsigned long long>(study.settings.max_checks));
}

std::string runs_html(const std::vector<RunRecord>& runs) {
  html::Table table{
      "Every run of the test set", {"begun, UTC", "commit", "queries", "s", "machine"}, {}};
  for (const RunRecord& run : runs) {
    const auto begun = static_cast<std::time_t>(run.begun_s);
    std::tm time{};
    gmtime_r(&begun, &time);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M", &time);
    table.rows.push_back({text, run.commit, std::to_string(run.planned),
                          formatted("%.0f", run.duration_s), run.machine});
  }
  return html::to_html(table);
}

std::string calibration_html(const Study& study, const std::vector<QueryResult>& results) {
  html::Table table{"Calibration, with uniform sampling alone (overshoot 1): mean checks",
                    {"robot", "ours", "deviation", "the paper's", "ratio", "solved"},
                    {}};
  for (const StudyRobot& robot : study.robots) {
    const CellResults cell =
        collect_cell(results, robot.model, uniform_name(1), study.settings.max_checks);
    if (cell.instances.empty())
      continue;
    const Moments checks = moments_of(flat(cell.checks));
    const bool known = robot.paper_checks > 0;
    table.rows.push_back({robot.model, formatted("%.0f", checks.mean),
                          formatted("%.0f", checks.deviation),
                          known ? formatted("%.0f", robot.paper_checks) : "",
                          known ? formatted("%.2f", checks.mean / robot.paper_checks) : "",
                          formatted("%zu/%zu", cell.solved_queries(), cell.queries())});
  }
  return table.rows.empty() ? "" : html::to_html(table);
}

/// The variants of a side study against uniform planning with the same overshoot.
std::string side_html(const Study& study, const StudyResults& results, const SideResults& side) {
  std::map<std::string, VariantCells> variants;
  std::vector<std::string> order;
  for (const WishedCell& wished : side.side.cells) {
    const std::string& robot = study.robots.at(wished.wish.target).model;
    const std::string variant = variant_of(wished.name);
    CellResults cell = collect_cell(side.results, robot, wished.name, study.settings.max_checks);
    // Without a distribution it is not guidance that is looked at, but another way to plan.
    const CellResults* const uniform = results.find(
        robot, wished.wish.profile.empty() ? results.uniform() : uniform_name(wished.overshoot));
    if (cell.instances.empty() || uniform == nullptr)
      continue;
    if (!variants.contains(variant))
      order.push_back(variant);
    const bool is_own = wished.wish.sources == std::vector<std::size_t>{wished.wish.target};
    variants[variant].push_back({std::move(cell), uniform, is_own});
  }
  std::vector<std::pair<std::string, VariantCells>> rows;
  for (const std::string& variant : order)
    rows.emplace_back(variant, std::move(variants.at(variant)));
  return html::to_html(variant_table(side.side.purpose, rows));
}

using Values = const std::vector<std::vector<double>>& (*)(const CellResults&);

std::string bars_svg(const StudyResults& results, const char* unit, Values values_of) {
  std::vector<BarGroup> groups;
  for (const std::string& robot : results.robots()) {
    BarGroup group{robot, {}};
    std::vector<std::string> guidances = {results.uniform()};
    guidances.insert(guidances.end(), results.robots().begin(), results.robots().end());
    for (const std::string& guidance : guidances)
      if (const CellResults* const cell = results.find(robot, guidance)) {
        const MeanInterval interval = mean_interval(instance_means(values_of(*cell)));
        group.bars.push_back({guidance, interval.mean, interval.low, interval.high});
      }
    groups.push_back(std::move(group));
  }
  return bar_figure(groups, unit);
}

std::string check_bars_svg(const StudyResults& results) {
  return bars_svg(
      results, "checks", [](const CellResults& cell) -> const auto& { return cell.checks; });
}

std::string figure_html(const std::string& svg, const char* caption) {
  return "<figure>" + svg + "<figcaption>" + html::escaped(caption) + "</figcaption></figure>\n";
}

bool is_flat(const Scene& scene) {
  for (const SceneObject& object : scene.objects)
    if (std::abs(object.T_task_object.translation().z()) > 0)
      return false;
  return true;
}

std::string clouds_html(const std::vector<StudyMember>& fleet,
                        const std::vector<Distribution>& distributions) {
  std::map<Digest, const StudyMember*> members;
  for (const StudyMember& member : fleet)
    members.emplace(member.digest, &member);
  std::string text = "<div class=\"views\">\n";
  for (const Distribution& distribution : distributions) {
    const auto target = members.find(distribution.robot);
    if (target == members.end() || !distribution.mixture || distribution.sources.empty())
      continue;
    const StudyMember& member = *target->second;
    const Scene scene = member.draw(seed_of(InstanceSet::Test, 0), 0).scene;
    const Cloud cloud =
        draw_cloud(member.robot.chain, member.placed.T_task_base, *distribution.mixture, scene, 1);
    const std::string title = member.label() + " from " + distribution.sources[0].label;
    text += cloud_figure(cloud, View::Top, title);
    if (!is_flat(scene))
      text += cloud_figure(cloud, View::Side, title + ", from the side");
  }
  return text + "</div>\n";
}

}  // namespace

void write_study_report(const Study& study, const std::vector<StudyMember>& fleet,
                        const ReportData& data, std::ostream& out) {
  const StudyResults results(study, data.test);
  std::map<Digest, std::string> labels;
  for (const StudyMember& member : fleet)
    labels.emplace(member.digest, member.label());
  std::string body =
      html::heading(1, "Kinship: study " + study.name) + html::paragraph(study.purpose + ".") +
      html::paragraph(protocol_text(study, data)) + runs_html(data.runs) +
      calibration_html(study, data.calibration) + html::heading(2, "What guidance was worth") +
      html::to_html(summary_table(results)) + html::to_html(pair_table(results)) +
      html::to_html(worst_source_table(results, data.distributions, labels)) +
      html::heading(2, "Checks, time and paths");
  for (const html::Table& table : cell_tables(results, paper_table(study.name)))
    body += html::to_html(table);
  body += figure_html(check_bars_svg(results),
                      "Mean collision checks with 95 % intervals over instances.");
  body += figure_html(
      bars_svg(
          results, "s", [](const CellResults& cell) -> const auto& { return cell.cpu_s; }),
      "Mean planning time with 95 % intervals over instances.");
  if (!data.sides.empty())
    body += html::heading(2, "Beyond the main tables");
  for (const SideResults& side : data.sides)
    body += side_html(study, results, side);
  if (study.is_constrained)
    body += html::paragraph(kNoPeers);
  body += html::heading(2, "Transfer and fit") +
          html::to_html(distribution_table(data.distributions, labels)) +
          html::heading(2, "What the distributions look like") +
          html::paragraph(formatted("Origins of the transfer frame of %d samples and the arm in %d "
                                    "of them, in the scene of the first test instance.",
                                    kCloudSamples, kCloudPostures)) +
          clouds_html(fleet, data.distributions);
  out << html::page("Kinship: study " + study.name, body);
  if (!out)
    throw Failure(ErrorCode::Storage, "the report cannot be written");
}

void write_checks_figure(const Study& study, const ReportData& data, std::ostream& out) {
  out << check_bars_svg(StudyResults(study, data.test));
  if (!out)
    throw Failure(ErrorCode::Storage, "the figure of the checks cannot be written");
}

}  // namespace kinship::experiments
