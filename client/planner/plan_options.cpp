#include "client/planner/plan_options.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <initializer_list>
#include <ostream>
#include <vector>

#include "client/arguments/command_options.hpp"
#include "client/arguments/number_range.hpp"
#include "proto/manual/manual.hpp"
#include "proto/manual/suggestion.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/exit_code.hpp"
#include "proto/types/names.hpp"
#include "robots/collision/edge_prover.hpp"

namespace kinship::planner {
namespace {

constexpr const char* kExamples = R"(
Examples:
  kinship-plan --robot arm.urdf --base base_link --tip tool0 --problems problems.jsonl
      plan with uniform samples; results on standard output
  kinship-plan --robot arm.urdf --base base_link --tip tool0 --srdf arm.srdf --package arm_description=src/arm_description
      --task box_to_shelf --problems problems.jsonl --guidance auto --report yes --json > results.jsonl
      register the robot, ask kinshipd for guidance, plan uniformly if there is none, report every attempt
  kinship-plan --robot mobile.urdf --base base_link --tip gripper_link --transfer "0 0 0.12 0 0 0 1" --hold head=0.4
      --label cell3 --task box_to_shelf --problems - --output results.jsonl
      a transfer frame in the palm, a joint off the chain held at 0.4; problems on standard input
  kinship-plan --robot robots/models/ur10e --task box_to_shelf --problems problems.jsonl --guidance always --sources panda,iiwa14
      --since 14d
      a model folder; every query guided, by these robots' experience of the last two weeks
  kinship-plan --robot robots/models/panda --problems problems.jsonl --guide retreat
      without experience and without a server: the hand backs out of its goal along the palm first
  kinship-plan --robot robots/models/panda --problems pour.jsonl --planner ompl:RRTConnect --max-checks 200000
      name the planner (without --planner: birrt, and cbirrt2 for problems with a constraint)

A problem that cannot be planned (start or goal in collision, goal out of reach, wrong number of joints, a planner that
cannot keep to a constraint) is answered with its reason, and the others are planned. proto/FORMATS.md has the formats.

Exit codes: 0 every line was answered (unsolved is an answer); 1 failed or interrupted, the robot was refused (its label belongs to
another robot), no problem fits it or could be read, or a report could not be kept; 2 wrong usage; 3 a file or folder does not exist, or
no such task or distribution (--guidance require); 4 no server answered (--guidance require).)";

std::vector<std::string> guide_words() {
  std::vector<std::string> words(Words<Guide>::kWords.begin(), Words<Guide>::kWords.end());
  words.emplace_back("auto");
  return words;
}

/// Options as the command line has them, to be looked at once all are known.
struct RawOptions {
  std::string planner;
  std::string guidance;
  std::string report = "no";
  std::string record_scenes = "yes";
  std::string record_search = "failed";
  std::string guide = "auto";
  double timeout_s = 5;
  double wait_s = 30;
  double resolution = 0;
  double guided_fraction = 0;
  double control_fraction = 0;
  arguments::SelectionArguments selection;
};

void add_inputs(CLI::App& app, PlanOptions& options) {
  app.add_option("--problems,problems", options.problems,
                 "problems, JSON Lines; - is standard input")
      ->required()
      ->type_name("FILE");
  app.add_option("--robot,--model,robot", options.robot.source,
                 "URDF file of the robot, or its model folder (robot.urdf and chain.toml)")
      ->required()
      ->type_name("FILE");
  arguments::add_robot_options(app, options.robot);
  arguments::add_without_meshes(app, options.robot);
}

void add_planning_options(CLI::App& app, PlanOptions& options, RawOptions& raw) {
  using arguments::between;
  constexpr std::uint64_t kMax = 1'000'000'000;
  guided::PlanSettings& settings = options.settings;
  app.add_option(
         "--planner", raw.planner,
         "birrt, cbirrt2, roadmap, rrtconnect (whole lines at once: the fastest without guidance, "
         "and without a constraint), or ompl:NAME with a planner of OMPL (RRT, RRTConnect, PRM, "
         "LazyPRM ...; default: birrt, and cbirrt2 for problems with a constraint)")
      ->check([](const std::string& text) {
        const Result<guided::PlannerChoice> planner = guided::parse_planner(text);
        return planner ? std::string() : planner.error().message;
      });
  CLI::Option* const clearance =
      app.add_option("--clearance", settings.clearance_m,
                     "what comes nearer to an obstacle counts as touching, m: every edge of a path "
                     "is proven to touch nothing, by bounds of how far the robot moves; of the "
                     "robot's own links, and what it holds, at most 1 mm is asked")
          ->check(between(collision::kLeastClearance_m, collision::kLargestRoom_m))
          ->capture_default_str();
  app.add_option("--resolution", raw.resolution,
                 "prove nothing, but check configurations that are at most so far apart, joint "
                 "units, as studies do: what is thinner may be missed")
      ->check(between(guided::kLeastResolution, guided::kLargestResolution))
      ->excludes(clearance);
  app.add_option("--max-checks", settings.max_checks, "collision checks after which to give up")
      ->check(between(std::uint64_t{1}, kMax))
      ->capture_default_str();
  app.add_option(
         "--shortcut-checks", settings.shortcut_checks,
         "collision checks spent each time a path is shortened, again where a line of it is "
         "refuted; 0: none")
      ->check(between(std::uint64_t{0}, kMax))
      ->capture_default_str();
  app.add_option("--overshoot", settings.overshoot,
                 "extend this much farther than the sample, for uniform and guided alike")
      ->check(between(1.0, 10.0))
      ->capture_default_str();
  app.add_option("--max-goals", settings.max_goals, "configurations looked for at a goal pose")
      ->check(between(1, 1000))
      ->capture_default_str();
  app.add_option("--limit-slack", settings.limit_slack,
                 "a start or goal beyond a joint limit by less than this is moved onto it, joint "
                 "units; 0: none is")
      ->check(between(0.0, 0.1))
      ->capture_default_str();
  app.add_option("--seed,--seed-offset", options.seed_offset,
                 "added to the seed of every problem (of one without: 0)")
      ->check(between(std::uint64_t{0}, kMax))
      ->capture_default_str();
  app.add_option("--output", options.output, "file for the results; standard output if missing")
      ->type_name("FILE");
  app.add_option("--searches", options.searches,
                 "file for how the trees of each search grew, which kinship results page draws; "
                 "makes planning a little slower")
      ->type_name("FILE");
  app.add_flag("--json", options.json,
               "results as JSON Lines also on a terminal; files and pipes get them anyway");
}

void add_guidance_options(CLI::App& app, PlanOptions& options, RawOptions& raw) {
  using arguments::between;
  app.add_option("--task", options.task, "task under which experience is kept")->type_name("TASK");
  app.add_option("--guidance", raw.guidance,
                 "uniform (or none): no guidance; auto: guided where that is cheaper, by what both "
                 "ways cost so far; always: every query for which there is guidance; require: as "
                 "auto, fails "
                 "without it (default: auto with --task, otherwise uniform, and always with "
                 "--guide retreat)")
      ->check(CLI::IsMember({"uniform", "none", "auto", "always", "require"}));
  arguments::add_profile_options(app, options.profile);
  arguments::add_selection_options(app, raw.selection);
  app.add_option(
         "--share", raw.guided_fraction,
         "share of guided samples in a guided query; the server's if missing; 0: all uniform")
      ->check(between(0.0, 1.0));
  app.add_option("--control-share", raw.control_fraction,
                 "part of the queries planned uniformly as control (default: chosen query by query "
                 "with --guidance auto, 0 with always)")
      ->check(between(0.0, 1.0));
  app.add_option(
         "--guide", raw.guide,
         "what guides a query: recall (stored paths, tried whole), retreat (the hand backs "
         "out first; needs neither --task nor a server), ways (stored ways of the hand, moved onto "
         "it), mixture (samples of the distribution), any of them joined by + in this order, or "
         "none; auto: what the server found best by planning "
         "recorded queries again, else all "
         "(default: auto, and mixture with a profile that begins with paper)")
      ->check(CLI::IsMember(guide_words()));
  app.add_flag(
      "--rehearsed", options.rehearsed,
      "wait for the server's rehearsal too, which takes seconds to minutes, once per robot, "
      "task and placement");
  app.add_option("--wait", raw.wait_s, "seconds to wait for a distribution that is being made")
      ->check(between(0.0, 3600.0))
      ->capture_default_str();
}

void add_server_options(CLI::App& app, PlanOptions& options, RawOptions& raw) {
  using arguments::between;
  app.add_option("--report", raw.report,
                 "report every attempt to the server; --report alone means yes")
      ->check(CLI::IsMember({"yes", "no"}))
      ->capture_default_str();
  app.add_option("--record-scenes", raw.record_scenes,
                 "reports carry the scene of their problem, by which other robots leave out "
                 "configurations that would touch it")
      ->check(CLI::IsMember({"yes", "no"}))
      ->capture_default_str();
  app.add_option(
         "--record-search", raw.record_search,
         "attempts that keep what explains them (start, goals, bodies in the way), for "
         "`kinship attempts`: never, failed ones, slow ones too (beyond the 95th percentile "
         "of this run), or all; slow and all with the trees of the search")
      ->check(CLI::IsMember({"never", "failed", "slow", "all"}))
      ->capture_default_str();
  app.add_option("--machine", options.machine,
                 "name of this robot or cell in reports (default: the host's)");
  arguments::add_server_address(app, {options.server, options.domain, options.security});
  app.add_option("--timeout", raw.timeout_s, "seconds to wait for a server")
      ->check(between(0.01, 3600.0))
      ->envname("KINSHIP_TIMEOUT")
      ->capture_default_str();
  app.add_option("--outbox", options.outbox, "folder of reports not yet acknowledged")
      ->type_name("FOLDER");
}

/// Options that say which experience is wanted.
constexpr std::initializer_list<const char*> kOfExperience = {
    "--profile", "--estimator", "--sources", "--weighting", "--since", "--wait", "--rehearsed"};
/// Options that say how guidance is used.
constexpr std::initializer_list<const char*> kOfSampling = {"--guide", "--share",
                                                            "--control-share"};
constexpr std::initializer_list<const char*> kOfReports = {"--machine", "--record-scenes",
                                                           "--record-search", "--outbox"};
constexpr std::initializer_list<const char*> kOfServer = {"--server", "--domain", "--timeout"};

std::chrono::milliseconds milliseconds_of(double seconds) {
  constexpr double kMilliseconds = 1000;
  return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * kMilliseconds));
}

void require_name(const std::optional<Error>& error, const std::string& option) {
  if (error)
    throw CLI::ValidationError(option, error->message);
}

/// On the command line; an address may come from the environment, and is then not told to be
/// unused.
bool is_given(const CLI::App& app, const std::string& option) {
  const std::string variable = app.get_option(option)->get_envname();
  return app.count(option) > 0 && (variable.empty() || std::getenv(variable.c_str()) == nullptr);
}

void require_task(const CLI::App& app, const PlanOptions& options) {
  if (!options.task.empty())
    return;
  if (options.report)
    throw CLI::ValidationError("--report", "needs --task");
  for (const char* option : kOfExperience)
    if (is_given(app, option))
      throw CLI::ValidationError(option, "needs --task: experience is kept by task");
  if (options.guide && !needs_experience(*options.guide))
    return;
  if (is_given(app, "--guide"))
    throw CLI::ValidationError("--guide", app.get_option("--guide")->as<std::string>() +
                                              " needs --task, whose experience it uses; retreat "
                                              "and none use none");
  if (options.guidance != GuidanceMode::Uniform)
    throw CLI::ValidationError("--guidance", "needs --task, or --guide retreat");
  for (const char* option : kOfSampling)
    if (is_given(app, option))
      throw CLI::ValidationError(option, "needs --task, or --guide retreat");
}

void note_unused(const CLI::App& app, const std::initializer_list<const char*>& unused,
                 const std::string& why, std::ostream& notes) {
  for (const char* option : unused)
    if (is_given(app, option))
      notes << "note: " << option << " has no effect " << why << '\n';
}

void note_unused(const CLI::App& app, const PlanOptions& options, std::ostream& notes) {
  const bool is_uniform = options.guidance == GuidanceMode::Uniform;
  const std::string why =
      is_uniform ? "with --guidance uniform" : "with a guide that needs no experience";
  if (!options.needs_experience())
    note_unused(app, kOfExperience, why, notes);
  if (is_uniform)
    note_unused(app, kOfSampling, why, notes);
  else if (options.sampling.guided_fraction == 0.0)
    note_unused(app, {"--control-share"}, "with --share 0", notes);
  if (!options.report)
    note_unused(app, kOfReports, "without --report yes", notes);
  if (options.settings.planner.kind == guided::PlannerKind::Ompl)
    note_unused(app, {"--overshoot"}, "on planners of OMPL", notes);
  if (!options.needs_experience() && !options.report) {
    note_unused(app, kOfServer, "where no server is needed", notes);
    note_unused(app, {"--task"}, "with neither experience nor reports", notes);
  }
}

GuidanceMode guidance_of(const RawOptions& raw, const PlanOptions& options) {
  if (raw.guidance.empty() && options.task.empty())
    return options.guide && !needs_experience(*options.guide) ? GuidanceMode::Always
                                                              : GuidanceMode::Uniform;
  if (raw.guidance.empty())
    return GuidanceMode::Auto;
  if (raw.guidance == "auto")
    return GuidanceMode::Auto;
  if (raw.guidance == "always")
    return GuidanceMode::Always;
  return raw.guidance == "require" ? GuidanceMode::Require : GuidanceMode::Uniform;
}

void complete_shares(const CLI::App& app, const RawOptions& raw, PlanOptions& options) {
  if (app.count("--share") > 0)
    options.sampling.guided_fraction = raw.guided_fraction;
  if (app.count("--control-share") > 0)
    options.sampling.control_fraction = raw.control_fraction;
  if (options.guidance != GuidanceMode::Always)
    return;
  if (options.sampling.guided_fraction == 0.0)
    throw CLI::ValidationError("--guidance", "always guides no query with --share 0");
  if (!options.sampling.control_fraction)
    options.sampling.control_fraction = 0;
}

/// Only reports carry search records.
guided::RecordSearch record_search_of(const RawOptions& raw, bool is_reported) {
  using enum guided::RecordSearch;
  if (!is_reported || raw.record_search == "never")
    return Never;
  if (raw.record_search == "failed")
    return Failed;
  return raw.record_search == "slow" ? Slow : All;
}

/// Sets the members of `options` that depend on several options.
/// \param app    parsed.
/// \param notes  for people: options that have no effect beside the others.
/// \throws CLI::ValidationError for options that do not go together.
void complete(const CLI::App& app, const RawOptions& raw, PlanOptions& options,
              std::ostream& notes) {
  if (!options.robot.label.empty())
    require_name(check_label(options.robot.label), "--label");
  if (app.count("--task") > 0)
    require_name(check_task(options.task), "--task");
  require_name(check_machine(options.machine), "--machine");
  if (!raw.planner.empty())
    options.settings.planner = guided::parse_planner(raw.planner).value_or_throw();
  options.report = raw.report == "yes";
  options.record_scenes = raw.record_scenes == "yes";
  options.settings.record_search = record_search_of(raw, options.report);
  if (raw.guide != "auto")
    options.guide = parse_word<Guide>(raw.guide).value_or_throw();
  else if (app.count("--guide") == 0 && options.profile.starts_with("paper"))
    options.guide = Guide::Mixture;
  options.guidance = guidance_of(raw, options);
  require_task(app, options);
  complete_shares(app, raw, options);
  options.selection =
      arguments::read_selection(raw.selection, std::chrono::system_clock::now()).value_or_throw();
  if (!raw.selection.sources.empty())
    options.sources = arguments::parse_robot_names(raw.selection.sources).value_or_throw();
  if (app.count("--resolution") > 0) {
    options.settings.resolution = raw.resolution;
    options.settings.clearance_m = 0;
  }
  options.timeout = milliseconds_of(raw.timeout_s);
  options.wait = milliseconds_of(raw.wait_s);
  note_unused(app, options, notes);
}

/// The arguments last to first, as CLI11 takes them; "--report" without a word as "--report=yes".
std::vector<std::string> reversed_arguments(int argc, const char* const* argv) {
  const std::vector<std::string> given(argv + 1, argv + argc);
  std::vector<std::string> reversed;
  for (std::size_t i = given.size(); i-- > 0;) {
    const bool has_word = i + 1 < given.size() && (given[i + 1] == "yes" || given[i + 1] == "no");
    reversed.push_back(given[i] == "--report" && !has_word ? "--report=yes" : given[i]);
  }
  return reversed;
}

}  // namespace

std::variant<PlanOptions, int> parse_plan_options(int argc, const char* const* argv,
                                                  std::ostream& out, std::ostream& err) {
  PlanOptions options;
  RawOptions raw;
  CLI::App app{"kinship-plan: plans motions of one robot, guided by the experience of its fleet",
               "kinship-plan"};
  manual::add_manual(app);
  app.footer(kExamples);
  add_inputs(app, options);
  add_planning_options(app, options, raw);
  add_guidance_options(app, options, raw);
  add_server_options(app, options, raw);
  try {
    app.parse(reversed_arguments(argc, argv));
    complete(app, raw, options, err);
  } catch (const CLI::ParseError& error) {
    return manual::explain(app, error, out, err);
  }
  return options;
}

}  // namespace kinship::planner
