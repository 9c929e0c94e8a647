#include "client/experiments/study_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <ostream>
#include <vector>

#include "client/arguments/command_options.hpp"
#include "client/experiments/peer.hpp"
#include "client/experiments/studies/fleet.hpp"
#include "client/experiments/studies/instance_draws.hpp"
#include "proto/files/output_file.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/rehearsal.hpp"

namespace kinship::experiments {
namespace {

constexpr std::uint32_t kQuickInstances = 6;  // quick runs in pipeline/ have as many

/// Told in Python whether it is given.
CLI::Option* add_flag(CLI::App& command, const char* name, const char* text) {
  return command.add_flag_callback(
      name, [] {}, text);
}

void add_run_options(CLI::App& command, StudyOptions& options) {
  command.add_option("--out", "folder of learning sets, results and the store")
      ->type_name("FOLDER")
      ->required();
  command.add_option("--models", options.models, "folder of the robots' model folders")
      ->capture_default_str();
  command
      .add_option("--kinshipd",
                  "program of the server that is started (default: beside this program)")
      ->type_name("FILE");
  command
      .add_option("--analysis",
                  "program that makes tables and figures of the results (default: "
                  "client/experiments/analyse.py of the sources)")
      ->type_name("FILE");
  command.add_option("--domain", "DDS domain of that server")
      ->type_name("UINT")
      ->envname("KINSHIP_DOMAIN")
      ->check(CLI::Range(0, 230))
      ->default_str("60");
  command.add_option("--threads", "instances that are planned side by side")
      ->type_name("INT")
      ->check(CLI::Range(1, 64))
      ->default_str("2");
  add_flag(command, "--resume", "go on with what the folder holds");
  command
      .add_option("--learning",
                  "learning instances of each robot instead of the study's; results in a folder of "
                  "their own, <study>-N")
      ->type_name("UINT")
      ->check(CLI::Range(1, 10'000));
  command.add_flag("--quick", options.is_quick,
                   "few instances (20 learning, 6 test), at most five minutes: shows that "
                   "everything works");
}

void add_tuning_options(CLI::App& command, StudyOptions& options) {
  CLI::Option* const tunes = add_flag(
      command, "--tuning", "plan tuning instances instead of test instances, with these options:");
  const auto add = [&](const char* name, const std::string& text, const char* type) {
    return command.add_option(name, CLI::callback_t(), text)->type_name(type)->needs(tunes);
  };
  for (CLI::Option* option : arguments::add_profile_options(command, options.profile))
    option->needs(tunes);
  add("--overshoot", "of uniform and guided queries", "FLOAT")->check(CLI::Range(1.0, 10.0));
  add("--share", "of guided samples", "FLOAT")->check(CLI::Range(0.0, 1.0));
  add("--guide", "what guides a query (default: what the server finds by rehearsal)", "TEXT")
      ->check(CLI::IsMember(
          std::vector<std::string>(Words<Guide>::kWords.begin(), Words<Guide>::kWords.end())));
  add("--instances", "tuning instances", "UINT")->check(CLI::Range(1, 10'000));
  add("--seeds", "queries per instance", "UINT")->check(CLI::Range(1, 100));
  const auto add_list = [&](const char* name, const std::string& text) {
    add(name, text, "TEXT")->expected(1, CLI::detail::expected_max_vector_size)->delimiter(',');
  };
  add_list("--robots", "robots that plan (default: all)");
  add_list("--sources",
           "robots whose experience is used (default: each by itself); others: that of all but "
           "the planning robot together");
}

void add_other_tasks(CLI::App& command, StudyOptions& options) {
  CLI::Option* const tunes = command.get_option("--tuning");
  command.add_option("--calibration", "plan so many calibration instances uniformly, nothing else")
      ->type_name("UINT")
      ->check(CLI::Range(1, 10'000))
      ->excludes(tunes);
  CLI::Option* const problems =
      command
          .add_option(
              "--problems", options.problems_of,
              "write the test instances of this robot for kinship-plan, on standard output; point "
              "clouds that they name go to OUT/clouds")
          ->excludes(tunes);
  command
      .add_option("--set", options.set, "instances that are written: others than test instances")
      ->check(CLI::IsMember({"calibration", "learning", "tuning", "test", "order"}))
      ->needs(problems);
  command
      .add_option("--count", options.instances, "so many instances are written, not the study's")
      ->check(CLI::Range(1, 10'000))
      ->needs(problems);
  command
      .add_option("--peer", options.peer,
                  "answer standard input as this planner of OMPL with experience instead of "
                  "writing them")
      ->needs(problems)
      ->group("");
  command.add_flag("--describe", options.describes, "write what the study is made of, as JSON");
  command
      .add_option("--study",
                  "side studies on the test instances: pooled, components, paper, scenes, sizes, "
                  "inverse, overshoot, roadmap, guides, oracle, peers")
      ->type_name("TEXT")
      ->expected(1, CLI::detail::expected_max_vector_size)
      ->delimiter(',')
      ->excludes(tunes);
  add_flag(command, "--report", "write the report of what the folder holds again, without planning")
      ->excludes(tunes);
}

void run_in_python(const StudyOptions& options) {
  results::Words words = results::words_of(*options.command);
  words["name"] = {options.study};
  words["profile"] = {options.profile};
  for (const Study* const study : find_studies(options.study))
    words["studies"].push_back(study->name);
  run_study_program(std::move(words));
}

/// Writes the point clouds of a problem, which names their files from here on.
void write_clouds(const std::filesystem::path& folder, Problem& problem) {
  for (SceneCloud& cloud : problem.scene.clouds) {
    std::filesystem::create_directories(folder);
    const std::filesystem::path file = std::filesystem::absolute(folder / cloud.cloud.file);
    files::OutputFile points(file, std::cout);
    for (const auto& p : cloud.cloud.voxels->colwise())
      points.stream() << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    points.keep();
    cloud.cloud.file = "file://" + file.string();
  }
}

void write_instances(const Study& study, const StudyOptions& options,
                     const std::vector<StudyMember>& fleet, std::ostream& out) {
  const std::size_t robot = find_member(fleet, options.problems_of);
  const std::uint32_t usual = options.is_quick ? kQuickInstances : study.test_instances;
  const std::uint32_t count = options.instances > 0 ? options.instances : usual;
  const std::uint64_t seed = seed_of(parse_instance_set(options.set), robot);
  const std::filesystem::path folder = options.command->get_option("--out")->as<std::string>();
  for (std::uint32_t index = 0; index < count; ++index) {
    Problem problem = fleet[robot].draw(seed, index);
    write_clouds(folder / "clouds", problem);
    out << json::to_json(problem) << '\n';
  }
}

/// The studies of a name; where a robot is meant, those of a family that have it.
/// \throws Failure(NotFound) if none has it.
std::vector<const Study*> studies_meant(const StudyOptions& options) {
  std::vector<const Study*> meant = find_studies(options.study);
  if (meant.size() > 1 && !options.problems_of.empty())
    std::erase_if(meant, [&](const Study* const study) {
      return std::ranges::find(study->robots, options.problems_of, &StudyRobot::model) ==
             study->robots.end();
    });
  if (meant.empty())
    throw Failure(ErrorCode::NotFound,
                  "no study of '" + options.study + "' has a robot '" + options.problems_of + "'");
  return meant;
}

}  // namespace

void run_study_program(results::Words words) {
  results::become_python(std::filesystem::path(KINSHIP_EXPERIMENTS_DIR) / "run_study.py",
                         std::move(words));
}

void add_study_commands(CLI::App& app, StudyOptions& options) {
  const auto add = [&](const std::string& name, const std::string& purpose) {
    CLI::App* const command = app.add_subcommand(name, purpose);
    add_run_options(*command, options);
    add_tuning_options(*command, options);
    add_other_tasks(*command, options);
    command->callback([&options, name, command] {
      options.study = name;
      options.command = command;
    });
  };
  for (const std::string& family : families())
    add(family, "every study whose name begins so, one after another");
  for (const Study& study : studies())
    add(study.name, study.purpose);
}

void run_study_command(const StudyOptions& options, std::istream& in, std::ostream& out) {
  if (!options.describes && options.problems_of.empty())
    run_in_python(options);
  for (const Study* const study : studies_meant(options)) {
    const std::vector<StudyMember> fleet = load_fleet(*study, options.models);
    if (options.describes)
      out << describe_study(*study, fleet);
    else if (options.peer.empty())
      write_instances(*study, options, fleet, out);
    else
      answer_as_peer(*study, fleet[find_member(fleet, options.problems_of)], options.peer, in, out);
  }
}

}  // namespace kinship::experiments
