#include "client/plan/plan_options.hpp"

#include <CLI/CLI.hpp>
#include <ostream>

#include "client/arguments/robot_options.hpp"
#include "client/arguments/selection_options.hpp"
#include "proto/types/exit_code.hpp"
#include "proto/types/names.hpp"

namespace kinship::plan {
namespace {

constexpr const char* kExamples = R"(
Examples:
  kinship-plan problems.jsonl --model robots/models/panda
      plan with uniform samples; results on standard output
  kinship-plan problems.jsonl --model robots/models/panda --task box_to_shelf --report --output results.jsonl
      ask kinshipd for guidance, plan uniformly if there is none, report every attempt
  kinship-plan problems.jsonl --model robots/models/ur10e --task box_to_shelf --guidance require --share 0.9
      fail without guidance: exit code 3 if the fleet has no experience, 4 if no server answers
  kinship-plan problems.jsonl --model robots/models/ur10e --task box_to_shelf --sources panda,iiwa14 --since 14d
      guidance from these robots' experience of the last two weeks only
  kinship-plan - cell3.urdf --base base_link --tip tool0 --transfer "0 0 0.12 0 0 0 1" --label cell3
      a robot without a model folder; problems on standard input

Exit codes: 0 every line was answered (unsolved is an answer), 1 failed or interrupted, 2 wrong usage,
3 a file or folder does not exist, or no such task or distribution (--guidance require), 4 no server answered (--guidance require).)";

/// What needs a second look after parsing.
struct RawOptions {
  std::string guidance;
  std::string record_scenes = "yes";
  double timeout_s = 5;
  double wait_s = 30;
  double share = 0;
  double control_share = 0;
  arguments::SelectionArguments selection;
};

void add_inputs(CLI::App& app, PlanOptions& options) {
  app.add_option("problems", options.problems, "problems, JSON Lines; - is standard input")
      ->required();
  CLI::Option* const robot =
      app.add_option("robot", options.robot.source, "URDF file of the robot, or its model folder");
  app.add_option("--model", options.robot.source, "model folder: robot.urdf and chain.toml")
      ->excludes(robot);
  arguments::add_robot_options(app, options.robot);
}

void add_planning_options(CLI::App& app, PlanOptions& options) {
  PlanSettings& settings = options.settings;
  app.add_option("--resolution", settings.resolution,
                 "largest distance between checked configurations, joint units")
      ->check(CLI::Range(1e-4, 1.0))
      ->capture_default_str();
  app.add_option("--max-checks", settings.max_checks, "collision checks after which to give up")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000'000}))
      ->capture_default_str();
  app.add_option("--shortcut-checks", settings.shortcut_checks,
                 "collision checks spent on shortening a path; 0: none")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1'000'000'000}))
      ->capture_default_str();
  app.add_option("--overshoot", settings.overshoot,
                 "extend this much farther than the sample, for uniform and guided alike")
      ->check(CLI::Range(1.0, 10.0))
      ->capture_default_str();
  app.add_option("--max-goals", settings.max_goals, "configurations looked for at a goal pose")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--seed-offset", options.seed_offset, "added to the seed of every problem");
  app.add_option("--output", options.output, "file for the results; standard output if missing");
}

void add_server_options(CLI::App& app, PlanOptions& options, RawOptions& raw) {
  app.add_option("--task", options.task, "task under which experience is kept");
  app.add_option("--guidance", raw.guidance,
                 "none: uniform; auto: guided if possible; require: fails without guidance "
                 "(default: auto with --task, otherwise none)")
      ->check(CLI::IsMember({"none", "auto", "require"}));
  app.add_option("--profile", options.profile, "profile of the distribution")
      ->capture_default_str();
  arguments::add_selection_options(app, raw.selection);
  app.add_option(
         "--share", raw.share,
         "share of guided samples in a guided query; the server's if missing; 0: all uniform")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option(
         "--control-share", raw.control_share,
         "part of the queries planned uniformly as control, 0 to 1 (default: chosen query by "
         "query, by what both ways cost so far)")
      ->check(CLI::Range(0.0, 1.0));
  app.add_flag("--report", options.report, "report every attempt to the server");
  app.add_option("--record-scenes", raw.record_scenes,
                 "reports carry the scene of their problem, by which other robots leave out "
                 "configurations that would touch it")
      ->check(CLI::IsMember({"yes", "no"}))
      ->capture_default_str();
  app.add_option("--machine", options.machine, "name of this robot or cell in reports");
  app.add_option("--domain", options.domain, "DDS domain")
      ->envname("KINSHIP_DOMAIN")
      ->check(CLI::Range(0, 230))
      ->capture_default_str();
  app.add_option("--timeout", raw.timeout_s, "seconds to wait for a server")
      ->check(CLI::Range(0.01, 3600.0))
      ->capture_default_str();
  app.add_option("--wait", raw.wait_s, "seconds to wait for a distribution that is being made")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  app.add_option("--outbox", options.outbox, "folder of reports not yet acknowledged");
}

std::chrono::milliseconds milliseconds_of(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1000));
}

void require_name(const std::optional<Error>& error, const std::string& option) {
  if (error)
    throw CLI::ValidationError(option, error->message);
}

void complete_selection(const arguments::SelectionArguments& raw, PlanOptions& options) {
  options.selection =
      arguments::read_selection(raw, std::chrono::system_clock::now()).value_or_throw();
  if (!raw.sources.empty())
    options.sources = arguments::parse_robot_names(raw.sources).value_or_throw();
}

/// What CLI11 cannot say by itself.
void complete(const CLI::App& app, const RawOptions& raw, PlanOptions& options) {
  if (options.robot.source.empty())
    throw CLI::ValidationError("robot", "give --model DIR, or a URDF with --base and --tip");
  if (!options.robot.label.empty())
    require_name(check_label(options.robot.label), "--label");

  const std::string guidance =
      raw.guidance.empty() ? (options.task.empty() ? "none" : "auto") : raw.guidance;
  options.guidance = guidance == "none"   ? GuidanceMode::None
                     : guidance == "auto" ? GuidanceMode::Auto
                                          : GuidanceMode::Require;
  if (options.task.empty() && options.guidance != GuidanceMode::None)
    throw CLI::ValidationError("--guidance", guidance + " needs --task");
  if (options.task.empty() && options.report)
    throw CLI::ValidationError("--report", "needs --task");
  options.record_scenes = raw.record_scenes == "yes";
  if (!options.task.empty())
    require_name(check_task(options.task), "--task");
  require_name(check_machine(options.machine), "--machine");
  if (app.count("--share") > 0)
    options.arms.share = raw.share;
  if (app.count("--control-share") > 0)
    options.arms.control_share = raw.control_share;
  complete_selection(raw.selection, options);
  options.timeout = milliseconds_of(raw.timeout_s);
  options.wait = milliseconds_of(raw.wait_s);
}

}  // namespace

std::variant<PlanOptions, int> parse_plan_options(int argc, const char* const* argv,
                                                  std::ostream& out, std::ostream& err) {
  PlanOptions options;
  RawOptions raw;
  CLI::App app{"kinship-plan: plans motions of one robot, guided by the experience of its fleet"};
  app.footer(kExamples);
  add_inputs(app, options);
  add_planning_options(app, options);
  add_server_options(app, options, raw);
  try {
    app.parse(argc, argv);
    complete(app, raw, options);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error, out, err);
    return code == 0 ? kDone : kWrongUsage;
  }
  return options;
}

}  // namespace kinship::plan
