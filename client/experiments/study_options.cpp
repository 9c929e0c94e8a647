#include "client/experiments/study_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string>

#include "client/arguments/command_options.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

constexpr std::uint32_t kDomain = 60, kMaxDomain = 230;

/// That of the environment, or kDomain. The commands share one value: CLI11 would write what the
/// environment says over what the command line of one of them said.
/// \throws Failure(InvalidInput)
std::uint32_t usual_domain() {
  const char* const text = std::getenv("KINSHIP_DOMAIN");
  if (text == nullptr || *text == '\0')
    return kDomain;
  std::uint32_t domain = 0;
  const char* const end = text + std::strlen(text);
  const auto [stopped, error] = std::from_chars(text, end, domain);
  if (error != std::errc() || stopped != end || domain > kMaxDomain)
    throw Failure(ErrorCode::InvalidInput, "KINSHIP_DOMAIN '" + std::string(text) +
                                               "' is not a DDS domain (0 to " +
                                               std::to_string(kMaxDomain) + ")");
  return domain;
}

void add_run_options(CLI::App& command, RunOptions& options) {
  command.add_option("--out", options.folder, "folder of learning sets, results and the store")
      ->required();
  command.add_option("--models", options.models, "folder of the robots' model folders")
      ->capture_default_str();
  command.add_option("--kinshipd", options.kinshipd,
                     "program of the server that is started (default: beside this program)");
  command
      .add_option("--analysis", options.analysis,
                  "program that makes tables and figures of the results")
      ->capture_default_str();
  command
      .add_option("--domain", options.domain,
                  "DDS domain of that server (default: KINSHIP_DOMAIN, or 60)")
      ->check(CLI::Range(std::uint32_t{0}, kMaxDomain))
      ->capture_default_str();
  command.add_option("--threads", options.threads, "instances that are planned side by side")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command.add_flag("--resume", options.resume, "go on with what the folder holds");
  command
      .add_option("--learning", options.learning,
                  "learning instances of each robot instead of the study's; results in a folder of "
                  "their own, <study>-N")
      ->check(CLI::Range(1, 10'000));
  command.add_flag("--quick", options.quick,
                   "few instances (" + std::to_string(kQuickLearning) + " learning, " +
                       std::to_string(kQuickInstances) +
                       " test), at most five minutes: shows that everything works");
}

void add_tuning_options(CLI::App& command, StudyOptions& options) {
  TuningOptions& tuning = options.tuning;
  CLI::Option* const tunes =
      command.add_flag("--tuning", options.tunes,
                       "plan tuning instances instead of test instances, with these options:");
  const auto add = [&](const std::string& name, auto& value, const std::string& text) {
    return command.add_option(name, value, text)->needs(tunes);
  };
  for (CLI::Option* option : arguments::add_profile_options(command, tuning.profile))
    option->needs(tunes);
  add("--overshoot", tuning.overshoot, "of uniform and guided queries")
      ->check(CLI::Range(1.0, 10.0));
  add("--share", tuning.share, "of guided samples")->check(CLI::Range(0.0, 1.0));
  command
      .add_option_function<std::string>(
          "--guide",
          [&tuning](const std::string& word) {
            tuning.guide = parse_word<Guide>(word).value_or_throw();
          },
          "what guides a query (default: what the server finds by rehearsal)")
      ->check(CLI::IsMember(
          std::vector<std::string>(Words<Guide>::kWords.begin(), Words<Guide>::kWords.end())))
      ->needs(tunes);
  add("--instances", tuning.instances, "tuning instances")->check(CLI::Range(1, 10'000));
  add("--seeds", tuning.seeds, "queries per instance")->check(CLI::Range(1, 100));
  add("--robots", tuning.targets, "robots that plan (default: all)")->delimiter(',');
  add("--sources", tuning.sources,
      "robots whose experience is used (default: each by itself); others: that of all but the "
      "planning robot together")
      ->delimiter(',');
  command
      .add_option("--calibration", options.calibration_instances,
                  "plan so many calibration instances uniformly, nothing else")
      ->check(CLI::Range(1, 10'000))
      ->excludes(tunes);
  command
      .add_option("--problems", options.problems_of,
                  "write the test instances of this robot for kinship-plan, on standard output")
      ->excludes(tunes);
  command
      .add_option("--study", options.sides,
                  "side studies on the test instances: pooled, components, paper, scenes, sizes, "
                  "inverse, overshoot, roadmap, guides, oracle, peers")
      ->delimiter(',')
      ->excludes(tunes);
  command
      .add_flag("--report", options.reports,
                "write the report of what the folder holds again, without planning")
      ->excludes(tunes);
}

bool is_family(const std::string& name) {
  const std::vector<std::string> known = families();
  return std::ranges::find(known, name) != known.end();
}

void run_one(const Study& study, const StudyOptions& options, std::ostream& out,
             std::ostream& messages) {
  for (const std::string& side : options.sides)
    run_side_study(study, side, options.run, messages);
  if (!options.sides.empty())
    return;
  if (!options.problems_of.empty())
    write_test_problems(study, options.run, options.problems_of, out);
  else if (options.reports)
    report_study(study, options.run, messages);
  else if (options.calibration_instances > 0)
    calibrate_study(study, options.run, options.calibration_instances, messages);
  else if (options.tunes)
    tune_study(study, options.run, options.tuning, messages);
  else
    run_study(study, options.run, messages);
}

}  // namespace

void add_study_commands(CLI::App& app, StudyOptions& options) {
  options.run.models = "robots/models";
  options.run.analysis = "client/experiments/analyse.py";
  options.run.domain = usual_domain();
  const auto add = [&](const std::string& name, const std::string& purpose) {
    CLI::App* const command = app.add_subcommand(name, purpose);
    add_run_options(*command, options.run);
    add_tuning_options(*command, options);
    command->callback([&options, name] { options.study = name; });
  };
  for (const std::string& family : families())
    add(family, "every study whose name begins so, one after another");
  for (const Study& study : studies())
    add(study.name, study.purpose);
}

void run_study_command(const StudyOptions& options, std::ostream& out, std::ostream& messages) {
  for (const Study* const study : find_studies(options.study))
    run_one(*study, options, out, messages);
  const bool has_results = options.problems_of.empty() && options.calibration_instances == 0 &&
                           !options.tunes && !options.run.quick && options.run.learning == 0;
  if (is_family(options.study) && has_results)
    report_family(options.study, options.run, messages);
}

}  // namespace kinship::experiments
