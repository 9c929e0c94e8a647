#include "client/planner/option_rules.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <initializer_list>
#include <ostream>

#include "client/planner/planner_choice.hpp"
#include "proto/types/names.hpp"

namespace kinship::planner {
namespace {

/// Options that say which distribution is wanted and how it is used.
constexpr std::initializer_list<const char*> kOfGuidance = {
    "--profile", "--estimator", "--sources",       "--weighting",
    "--since",   "--share",     "--control-share", "--wait"};
constexpr std::initializer_list<const char*> kOfReports = {"--machine", "--record-scenes",
                                                           "--outbox"};
constexpr std::initializer_list<const char*> kOfServer = {"--server", "--domain", "--timeout"};

std::chrono::milliseconds milliseconds_of(double seconds) {
  constexpr double kMilliseconds = 1000;
  return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * kMilliseconds));
}

void require_name(const std::optional<Error>& error, const std::string& option) {
  if (error)
    throw CLI::ValidationError(option, error->message);
}

/// On the command line; a domain may come from the environment, and is then not told to be unused.
bool is_given(const CLI::App& app, const std::string& option) {
  return app.count(option) > 0 &&
         (option != "--domain" || std::getenv("KINSHIP_DOMAIN") == nullptr);
}

void require_task(const CLI::App& app, const PlanOptions& options) {
  if (!options.task.empty())
    return;
  if (options.guidance != GuidanceMode::Uniform)
    throw CLI::ValidationError("--guidance", "needs --task");
  if (options.report)
    throw CLI::ValidationError("--report", "needs --task");
  for (const char* option : kOfGuidance)
    if (is_given(app, option))
      throw CLI::ValidationError(option, "needs --task: there is no guidance without one");
}

void note_unused(const CLI::App& app, const std::initializer_list<const char*>& unused,
                 const std::string& why, std::ostream& notes) {
  for (const char* option : unused)
    if (is_given(app, option))
      notes << "note: " << option << " has no effect " << why << '\n';
}

void note_unused(const CLI::App& app, const PlanOptions& options, std::ostream& notes) {
  const bool is_uniform = options.guidance == GuidanceMode::Uniform;
  if (is_uniform)
    note_unused(app, kOfGuidance, "with --guidance uniform", notes);
  else if (options.arms.share == 0.0)
    note_unused(app, {"--control-share"}, "with --share 0", notes);
  if (!options.report)
    note_unused(app, kOfReports, "without --report yes", notes);
  if (options.settings.planner.kind == PlannerKind::Ompl)
    note_unused(app, {"--overshoot"}, "on planners of OMPL", notes);
  if (is_uniform && !options.report) {
    note_unused(app, kOfServer, "where no server is needed", notes);
    note_unused(app, {"--task"}, "with neither guidance nor reports", notes);
  }
}

GuidanceMode guidance_of(const RawOptions& raw, const PlanOptions& options) {
  if (raw.guidance.empty())
    return options.task.empty() ? GuidanceMode::Uniform : GuidanceMode::Auto;
  if (raw.guidance == "auto")
    return GuidanceMode::Auto;
  if (raw.guidance == "always")
    return GuidanceMode::Always;
  return raw.guidance == "require" ? GuidanceMode::Require : GuidanceMode::Uniform;
}

void complete_shares(const CLI::App& app, const RawOptions& raw, PlanOptions& options) {
  if (app.count("--share") > 0)
    options.arms.share = raw.share;
  if (app.count("--control-share") > 0)
    options.arms.control_share = raw.control_share;
  if (options.guidance != GuidanceMode::Always)
    return;
  if (options.arms.share == 0.0)
    throw CLI::ValidationError("--guidance", "always guides no query with --share 0");
  if (!options.arms.control_share)
    options.arms.control_share = 0;
}

}  // namespace

void complete(const CLI::App& app, const RawOptions& raw, PlanOptions& options,
              std::ostream& notes) {
  if (!options.robot.label.empty())
    require_name(check_label(options.robot.label), "--label");
  if (app.count("--task") > 0)
    require_name(check_task(options.task), "--task");
  require_name(check_machine(options.machine), "--machine");
  if (!raw.planner.empty())
    options.settings.planner = parse_planner(raw.planner).value_or_throw();
  options.guidance = guidance_of(raw, options);
  options.report = raw.report == "yes";
  options.record_scenes = raw.record_scenes == "yes";
  require_task(app, options);
  complete_shares(app, raw, options);
  options.selection =
      arguments::read_selection(raw.selection, std::chrono::system_clock::now()).value_or_throw();
  if (!raw.selection.sources.empty())
    options.sources = arguments::parse_robot_names(raw.selection.sources).value_or_throw();
  options.timeout = milliseconds_of(raw.timeout_s);
  options.wait = milliseconds_of(raw.wait_s);
  note_unused(app, options, notes);
}

}  // namespace kinship::planner
