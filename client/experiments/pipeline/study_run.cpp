#include "client/experiments/pipeline/study_run.hpp"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>

#include "client/experiments/formatted.hpp"
#include "client/experiments/pipeline/analysis_process.hpp"
#include "client/experiments/pipeline/compressed_file.hpp"
#include "client/experiments/pipeline/peer_study.hpp"
#include "client/experiments/pipeline/run_record.hpp"
#include "client/experiments/pipeline/side_study.hpp"
#include "client/experiments/pipeline/study_description.hpp"
#include "client/experiments/pipeline/study_session.hpp"
#include "client/experiments/studies/instance_draws.hpp"
#include "proto/files/output_file.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

/// Uniform planning, named after its overshoot.
Cell uniform_cell(std::size_t robot, guided::PlanSettings settings, double overshoot) {
  settings.overshoot = overshoot;
  settings.shortcut_checks = 0;
  return {robot, uniform_name(overshoot), settings, std::nullopt};
}

/// Uniform cells of a robot: with the overshoot that guided cells have, and plain.
std::vector<Cell> uniform_cells(std::size_t robot, const guided::PlanSettings& settings) {
  std::vector<Cell> cells = {uniform_cell(robot, settings, settings.overshoot)};
  if (settings.overshoot != 1)
    cells.push_back(uniform_cell(robot, settings, 1));
  return cells;
}

std::optional<Cell> guided_cell(const StudyMember& member, std::optional<Guide> guide, Cell cell,
                                const Fetched& fetched, double share) {
  cell.settings.shortcut_checks = 0;
  if (!guide_by(guide, member, fetched, share, cell))
    return std::nullopt;
  return cell;
}

/// The cells of the main tables: uniform, and guided by each robot alone.
std::vector<Cell> main_cells(const Study& study, StudySession& session,
                             std::ostream& distributions) {
  std::vector<Cell> cells;
  for (std::size_t target = 0; target < session.fleet().size(); ++target) {
    for (Cell& cell : uniform_cells(target, study.settings))
      cells.push_back(std::move(cell));
    for (std::size_t source = 0; source < session.fleet().size(); ++source) {
      const Fetched fetched = session.fetch({study.name, target, {source}, "default"});
      distributions << json::to_json(fetched.distribution) << '\n';
      if (auto cell = guided_cell(session.fleet()[target], std::nullopt,
                                  {target, session.fleet()[source].label(), study.settings, {}},
                                  fetched, study.guided_share))
        cells.push_back(*std::move(cell));
    }
  }
  return cells;
}

/// Only whose guide is not given waits for a rehearsal.
DistributionWish rehearsed_if_needed(const WishedCell& wished) {
  DistributionWish wish = wished.wish;
  wish.rehearsed = !wished.guide.has_value();
  return wish;
}

/// The cells of a side study, and uniform ones, so that both had the same load; a server is started
/// only if there is something to fetch.
std::vector<Cell> side_cells(const Study& study, const SideStudy& side, StudySession& session) {
  const auto is_uniform = [](const WishedCell& wished) { return wished.wish.profile.empty(); };
  if (!std::ranges::all_of(side.cells, is_uniform))
    session.learn();
  for (const SideStudy::Shortened& shortened : side.shortened)
    session.report_as(shortened.task, shortened.paths);
  std::vector<Cell> cells;
  for (std::size_t robot = 0; robot < session.fleet().size(); ++robot)
    cells.push_back(uniform_cell(robot, study.settings, study.settings.overshoot));
  for (const WishedCell& wished : side.cells) {
    guided::PlanSettings settings = study.settings;
    settings.overshoot = wished.overshoot;
    settings.planner.kind = wished.planner;
    if (wished.retreat_m)
      settings.tracks.retreat_m = *wished.retreat_m;
    if (is_uniform(wished)) {
      cells.push_back(uniform_cell(wished.wish.target, settings, wished.overshoot));
      cells.back().name = wished.name;
      cells.back().oracle_deviation = wished.oracle_deviation;
      if (wished.oracle_deviation)  // no gate doubts an answer
        cells.back().settings.gate_distance = std::numeric_limits<double>::infinity();
    } else if (auto cell = guided_cell(session.fleet()[wished.wish.target], wished.guide,
                                       {wished.wish.target, wished.name, settings, {}},
                                       session.fetch(rehearsed_if_needed(wished)), wished.share)) {
      cells.push_back(*std::move(cell));
    }
  }
  return cells;
}

RunRecord finished(RunRecord record, std::chrono::steady_clock::time_point begin,
                   std::size_t planned) {
  record.planned = planned;
  record.duration_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return record;
}

QueryPlan test_plan(const Study& study, const RunOptions& options) {
  QueryPlan plan;
  plan.seed = seed_of(InstanceSet::Test, 0);
  plan.instances = options.quick ? kQuickInstances : study.test_instances;
  plan.seeds = options.quick ? 1 : kTestSeeds;
  return plan;
}

/// Has the results of a study analysed. \throws Failure(Internal)
void analyse(const Study& study, const RunOptions& options, const std::string& option) {
  const StudyFiles files(study, options);
  files::OutputFile description(files.description, std::cout);
  description.stream() << describe_study(study, load_fleet(study, options.models),
                                         learning_instances(study, options));
  description.keep();
  const AnalysisRun run{options.analysis, files.folder, option};
  if (!run_analysis(run))
    throw Failure(ErrorCode::Internal,
                  "the results are not analysed; to have it done: " + run.command());
}

/// The same when a study was run: its results are there, with or without a report.
void try_to_report(const Study& study, const RunOptions& options, std::ostream& messages) {
  try {
    report_study(study, options, messages);
  } catch (const Failure& failure) {
    messages << study.name << ": " << failure.what() << std::endl;
  }
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
         std::to_string(distribution.revision) + " f" +
         formatted("%g s%g ", overshoot, tuning.share) +
         (tuning.guide ? std::string(to_text(*tuning.guide)) : "rehearsed");
}

}  // namespace

void run_study(const Study& study, const RunOptions& options, std::ostream& messages) {
  const auto begin = std::chrono::steady_clock::now();
  RunRecord record = begin_run(study.name, "");
  StudySession session(study, options, messages);
  session.learn();
  files::OutputFile distributions(session.files().distributions, messages);
  const std::vector<Cell> cells = main_cells(study, session, distributions.stream());
  distributions.keep();
  QueryLog log(session.files().test);
  const std::size_t known = log.results().size();
  session.run("test", cells, test_plan(study, options), log);
  append_run(session.files().runs,
             finished(std::move(record), begin, log.results().size() - known));
  compress_file(session.files().test);
  compress_file(session.files().distributions);
  try_to_report(study, options, messages);
}

void run_side_study(const Study& study, const std::string& name, const RunOptions& options,
                    std::ostream& messages) {
  const SideStudy side = find_side_study(study, name);
  const auto begin = std::chrono::steady_clock::now();
  RunRecord record = begin_run(study.name, name);
  RunOptions again = options;
  again.resume = true;
  StudySession session(study, again, messages);
  QueryLog log(session.files().side(name));
  const std::size_t known = log.results().size();
  if (side.is_of_peers) {
    session.record();
    QueryPlan plan = test_plan(study, options);
    plan.threads = options.threads;
    run_peers(study, session.fleet(), session.learning_sets(), plan, log, messages);
  } else {
    const std::vector<Cell> cells = side_cells(study, side, session);
    session.run(name, cells, test_plan(study, options), log);
  }
  append_run(session.files().runs,
             finished(std::move(record), begin, log.results().size() - known));
  compress_file(session.files().side(name));
  try_to_report(study, again, messages);
}

void report_study(const Study& study, const RunOptions& options, std::ostream& messages) {
  analyse(study, options, "");
  messages << study.name << ": " << (StudyFiles(study, options).folder / "RESULTS.md").string()
           << std::endl;
}

void report_family(const std::string& family, const RunOptions& options, std::ostream& messages) {
  const AnalysisRun run{options.analysis, options.folder, "--family=" + family};
  if (!run_analysis(run))
    throw Failure(ErrorCode::Internal,
                  "the family is not analysed; to have it done: " + run.command());
  messages << family << ": " << (options.folder / (family + ".md")).string() << std::endl;
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
                std::ostream& messages) {
  RunOptions again = options;
  again.resume = true;
  StudySession session(study, again, messages);
  session.learn();
  guided::PlanSettings settings = study.settings;
  settings.overshoot = tuning.overshoot.value_or(study.settings.overshoot);
  std::vector<Cell> cells;
  nlohmann::ordered_json compared{{"uniform", uniform_name(settings.overshoot)},
                                  {"pairs", nlohmann::ordered_json::array()}};
  for (const std::size_t target : chosen_robots(session.fleet(), tuning.targets)) {
    const std::string& label = session.fleet()[target].label();
    for (Cell& cell : uniform_cells(target, settings))
      cells.push_back(std::move(cell));
    for (const NamedSources& sources : chosen_sources(session.fleet(), tuning.sources, target)) {
      const Fetched fetched = session.fetch(
          {study.name, target, sources.robots, tuning.profile, !tuning.guide.has_value()});
      const std::string name =
          tuning_name(sources.name, tuning, settings.overshoot, fetched.distribution);
      if (auto cell = guided_cell(session.fleet()[target], tuning.guide,
                                  {target, name, settings, {}}, fetched, tuning.share)) {
        cells.push_back(*std::move(cell));
        compared["pairs"].push_back(
            {{"robot", label}, {"source", sources.name}, {"guidance", name}});
      }
    }
  }
  QueryLog log(session.files().tuning);
  session.run("tuning", cells,
              {seed_of(InstanceSet::Tuning, 0), tuning.instances, tuning.seeds, 1, {}}, log);
  files::OutputFile pairs(session.files().tuning_pairs, std::cout);
  pairs.stream() << compared.dump(1) << '\n';
  pairs.keep();
  analyse(study, again, "--tuning");
}

void calibrate_study(const Study& study, const RunOptions& options, std::uint32_t instances,
                     std::ostream& messages) {
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
  analyse(study, again, "--calibration");
}

}  // namespace kinship::experiments
