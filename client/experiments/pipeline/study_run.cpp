#include "client/experiments/pipeline/study_run.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <ostream>

#include "client/experiments/analysis/ratio_table.hpp"
#include "client/experiments/pipeline/compressed_file.hpp"
#include "client/experiments/pipeline/peer_study.hpp"
#include "client/experiments/pipeline/run_record.hpp"
#include "client/experiments/pipeline/side_study.hpp"
#include "client/experiments/pipeline/study_session.hpp"
#include "client/experiments/report/study_report.hpp"
#include "client/files/lines.hpp"
#include "client/files/output_file.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/problem_json.hpp"

namespace kinship::experiments {
namespace {

constexpr std::uint32_t kTestSeeds = 4;
constexpr std::uint32_t kQuickInstances = 6;

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// Uniform planning, named after its overshoot.
Cell uniform_cell(std::size_t robot, plan::PlanSettings settings, double overshoot) {
  settings.overshoot = overshoot;
  settings.shortcut_checks = 0;
  return {robot, uniform_name(overshoot), settings, std::nullopt};
}

/// Uniform cells of a robot: with the overshoot that guided cells have, and plain.
std::vector<Cell> uniform_cells(std::size_t robot, const plan::PlanSettings& settings) {
  std::vector<Cell> cells = {uniform_cell(robot, settings, settings.overshoot)};
  if (settings.overshoot != 1)
    cells.push_back(uniform_cell(robot, settings, 1));
  return cells;
}

std::optional<Cell> guided_cell(std::size_t robot, std::string name, plan::PlanSettings settings,
                                const Distribution& distribution, double share) {
  settings.shortcut_checks = 0;
  std::optional<plan::Guidance> guidance = always_guided(distribution, share);
  if (!guidance)
    return std::nullopt;
  return Cell{robot, std::move(name), settings, std::move(guidance)};
}

/// The cells of the main tables: uniform, and guided by each robot alone.
std::vector<Cell> main_cells(const Study& study, StudySession& session,
                             std::ostream& distributions) {
  std::vector<Cell> cells;
  for (std::size_t target = 0; target < session.fleet().size(); ++target) {
    for (Cell& cell : uniform_cells(target, study.settings))
      cells.push_back(std::move(cell));
    for (std::size_t source = 0; source < session.fleet().size(); ++source) {
      const Distribution distribution = session.fetch({study.name, target, {source}, "default"});
      distributions << json::to_json(distribution) << '\n';
      if (auto cell = guided_cell(target, session.fleet()[source].label(), study.settings,
                                  distribution, study.guided_share))
        cells.push_back(*std::move(cell));
    }
  }
  return cells;
}

/// The cells of a side study; a server is started only if there is something to fetch.
std::vector<Cell> side_cells(const Study& study, const SideStudy& side, StudySession& session) {
  const auto is_uniform = [](const WishedCell& wished) { return wished.wish.profile.empty(); };
  if (!std::ranges::all_of(side.cells, is_uniform))
    session.learn();
  for (const SideStudy::Shortened& shortened : side.shortened)
    session.report_as(shortened.task, shortened.paths);
  std::vector<Cell> cells;
  for (const WishedCell& wished : side.cells) {
    plan::PlanSettings settings = study.settings;
    settings.overshoot = wished.overshoot;
    settings.planner.kind = wished.planner;
    if (is_uniform(wished)) {
      cells.push_back(uniform_cell(wished.wish.target, settings, wished.overshoot));
      cells.back().name = wished.name;
    } else if (auto cell = guided_cell(wished.wish.target, wished.name, settings,
                                       session.fetch(wished.wish), wished.share)) {
      cells.push_back(*std::move(cell));
    }
  }
  return cells;
}

QueryPlan test_plan(const Study& study, const RunOptions& options) {
  QueryPlan plan;
  plan.seed = seed_of(InstanceSet::Test, 0);
  plan.instances = options.quick ? kQuickInstances : study.test_instances;
  plan.seeds = options.quick ? 1 : kTestSeeds;
  return plan;
}

/// Fetched distributions as run_study wrote them.
std::vector<Distribution> read_distributions(const std::filesystem::path& file) {
  expand_file(file);
  std::vector<Distribution> distributions;
  std::ifstream stream = files::open_input(file);
  files::for_each_line(stream, file.string(), [&](const files::Line& line) {
    Result<Distribution> distribution =
        line.text ? json::distribution_from_json(*line.text) : line.text.error();
    distributions.push_back(std::move(distribution).value_or_throw());
    return true;
  });
  return distributions;
}

std::vector<std::size_t> chosen_robots(const std::vector<StudyMember>& fleet,
                                       const std::vector<std::string>& labels) {
  std::vector<std::size_t> robots;
  for (const std::string& label : labels)
    robots.push_back(find_member(fleet, label));
  for (std::size_t robot = 0; labels.empty() && robot < fleet.size(); ++robot)
    robots.push_back(robot);
  return robots;
}

/// Experience of one or several robots, by the name that the table of a tuning run gives it.
struct NamedSources {
  std::string name;
  std::vector<std::size_t> robots;
};

/// \param labels  robots, or kOtherRobots for all but the target together; empty: each robot by
/// itself.
std::vector<NamedSources> chosen_sources(const std::vector<StudyMember>& fleet,
                                         const std::vector<std::string>& labels,
                                         std::size_t target) {
  std::vector<NamedSources> chosen;
  if (labels.empty())
    for (std::size_t robot = 0; robot < fleet.size(); ++robot)
      chosen.push_back({fleet[robot].label(), {robot}});
  for (const std::string& label : labels) {
    if (label != kOtherRobots) {
      chosen.push_back({label, {find_member(fleet, label)}});
      continue;
    }
    NamedSources others{label, {}};
    for (std::size_t robot = 0; robot < fleet.size(); ++robot)
      if (robot != target)
        others.robots.push_back(robot);
    chosen.push_back(std::move(others));
  }
  return chosen;
}

/// Where a tuning result belongs: a source and all that was varied. The distribution stands for
/// profile, engines and experience.
std::string tuning_name(const std::string& source, const TuningOptions& tuning, double overshoot,
                        const Distribution& distribution) {
  return source + " " + tuning.profile + " " + distribution.id.short_hex() + " r" +
         std::to_string(distribution.revision) + " f" + number_text(overshoot) + " s" +
         number_text(tuning.share);
}

}  // namespace

void run_study(const Study& study, const RunOptions& options, std::ostream& messages) {
  const auto begin = std::chrono::steady_clock::now();
  RunRecord record = begin_run(study.name);
  StudySession session(study, options, messages);
  session.learn();
  files::OutputFile distributions(session.files().distributions, messages);
  const std::vector<Cell> cells = main_cells(study, session, distributions.stream());
  distributions.keep();
  QueryLog log(session.files().test);
  const std::size_t known = log.results().size();
  session.run("test", cells, test_plan(study, options), log);
  record.planned = log.results().size() - known;
  record.duration_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  append_run(session.files().runs, record);
  compress_file(session.files().test);
  compress_file(session.files().distributions);
  report_study(study, options, messages);
}

void run_side_study(const Study& study, const std::string& name, const RunOptions& options,
                    std::ostream& messages) {
  const SideStudy side = find_side_study(study, name);
  RunOptions again = options;
  again.resume = true;
  StudySession session(study, again, messages);
  QueryLog log(session.files().side(name));
  if (side.is_of_peers) {
    session.record();
    QueryPlan plan = test_plan(study, options);
    plan.threads = options.threads;
    run_peers(study, session.fleet(), session.learning_sets(), plan, log, messages);
  } else {
    const std::vector<Cell> cells = side_cells(study, side, session);
    session.run(name, cells, test_plan(study, options), log);
  }
  compress_file(session.files().side(name));
  report_study(study, again, messages);
}

void report_study(const Study& study, const RunOptions& options, std::ostream& messages) {
  const StudyFiles files(study, options);
  ReportData data;
  if (expand_file(files.calibration))
    data.calibration = read_query_results(files.calibration);
  data.test = read_query_results(files.test);
  data.distributions = read_distributions(files.distributions);
  data.runs = read_runs(files.runs);
  for (const SideStudy& side : side_studies(study))
    if (expand_file(files.side(side.name)))
      data.sides.push_back({side, read_query_results(files.side(side.name))});
  files::OutputFile page(files.report, messages);
  write_study_report(study, load_fleet(study, options.models), data, page.stream());
  page.keep();
  files::OutputFile figure(files.checks_figure, messages);
  write_checks_figure(study, data, figure.stream());
  figure.keep();
  messages << study.name << ": " << files.report.string() << std::endl;
}

void write_test_problems(const Study& study, const RunOptions& options, const std::string& robot,
                         std::ostream& out) {
  const std::vector<StudyMember> fleet = load_fleet(study, options.models);
  const StudyMember& member = fleet[find_member(fleet, robot)];
  const QueryPlan plan = test_plan(study, options);
  for (std::uint32_t index = 0; index < plan.instances; ++index)
    out << json::to_json(member.draw(plan.seed, index)) << '\n';
}

void tune_study(const Study& study, const RunOptions& options, const TuningOptions& tuning,
                std::ostream& out, std::ostream& messages) {
  RunOptions again = options;
  again.resume = true;
  StudySession session(study, again, messages);
  session.learn();
  plan::PlanSettings settings = study.settings;
  settings.overshoot = tuning.overshoot.value_or(study.settings.overshoot);
  std::vector<Cell> cells;
  RatioTable table;
  for (const std::size_t target : chosen_robots(session.fleet(), tuning.targets)) {
    const std::string& label = session.fleet()[target].label();
    for (Cell& cell : uniform_cells(target, settings))
      cells.push_back(std::move(cell));
    for (const NamedSources& sources : chosen_sources(session.fleet(), tuning.sources, target)) {
      const Distribution distribution =
          session.fetch({study.name, target, sources.robots, tuning.profile});
      const std::string name = tuning_name(sources.name, tuning, settings.overshoot, distribution);
      if (auto cell = guided_cell(target, name, settings, distribution, tuning.share)) {
        cells.push_back(*std::move(cell));
        table.pairs.push_back({label, sources.name, name, sources.name == label});
      }
    }
  }
  QueryLog log(session.files().tuning);
  session.run("tuning", cells,
              {seed_of(InstanceSet::Tuning, 0), tuning.instances, tuning.seeds, 1, {}}, log);
  table.overshoot = settings.overshoot;
  table.max_checks = settings.max_checks;
  write_ratio_table(table, log.results(), out);
}

void calibrate_study(const Study& study, const RunOptions& options, std::uint32_t instances,
                     std::ostream& out, std::ostream& messages) {
  RunOptions again = options;
  again.resume = true;
  StudySession session(study, again, messages);
  std::vector<Cell> cells;
  for (std::size_t robot = 0; robot < session.fleet().size(); ++robot)
    cells.push_back(uniform_cell(robot, study.settings, 1));
  QueryLog log(session.files().calibration);
  session.run("calibration", cells, {seed_of(InstanceSet::Calibration, 0), instances, 1, 1, {}},
              log);
  compress_file(session.files().calibration);
  write_calibration(study, log.results(), out);
}

}  // namespace kinship::experiments
