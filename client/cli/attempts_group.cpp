#include "client/cli/attempt_commands.hpp"
#include "client/cli/listings.hpp"
#include "client/cli/plot_commands.hpp"
#include "client/cli/session.hpp"
#include "client/cli/show_commands.hpp"
#include "proto/types/attempt_filter.hpp"

namespace kinship::cli {
namespace {

constexpr const char* kAttemptId =
    "UUID of the report, or its first eight digits, as attempts list shows them";
constexpr const char* kExampleAttempt = "7a0e3a52-8f0c-4d0a-9d43-2f6b7f0c1e55";

void add_attempt_list(CLI::App& group, Session& session) {
  struct Options : AttemptListOptions {
    std::string outcome = "all", since;
    bool is_slowest = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(group, "list", "List attempts, solved or not, the newest first",
                  "kinship attempts list --outcome unsolved --since 1d\n"
                  "  kinship attempts list --task box_to_shelf --slowest --limit 20");
  command->add_option("--outcome", options->outcome, "Of this outcome")
      ->check(CLI::IsMember({"all", "solved", "unsolved", "timeout", "failed"}))
      ->capture_default_str();
  command->add_option("--task", options->task, "Of this task")->type_name("TASK");
  command->add_option("--robot", options->robot, "Of this robot: label or digest prefix")
      ->type_name("ROBOT");
  add_since(*command, options->since);
  command->add_flag("--slowest", options->is_slowest,
                    "By planning time, of the newest 10 000 that match");
  constexpr std::size_t kMostRows = 1'000'000'000;
  command->add_option("--limit", options->limit, "Rows at most; 0: all")
      ->check(CLI::Range(std::size_t{0}, kMostRows))
      ->capture_default_str();
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, options](link::Client& server) {
    options->json = session.json;
    std::string filter = "outcome=" + options->outcome;
    if (options->is_slowest)
      filter += ",order=slowest";
    options->filter = attempt_filter_from_text(filter).value_or_throw();
    options->filter.since_ms = since_ms(options->since);
    return list_attempts(server, *options, session.out, session.err);
  });
}

void add_problem_export(CLI::App& group, Session& session) {
  const auto options = std::make_shared<AttemptExportOptions>();
  CLI::App* command = add_command(
      group, "export", "The problem of an attempt, for kinship-plan to plan again",
      std::string("kinship attempts export ") + kExampleAttempt + " --output query.jsonl\n" +
          "  kinship-plan --problems query.jsonl --robot panda --guidance uniform");
  command->add_option("id", options->id, kAttemptId)->required()->type_name("ID");
  command->add_option("--output", options->output, "File (default: standard output)")
      ->type_name("FILE");
  on_run_with_server(*command, session, [&session, options](link::Client& server) {
    return export_attempt(server, *options, session.out, session.err);
  });
}

}  // namespace

void add_attempts(CLI::App& app, Session& session) {
  CLI::App* attempts =
      add_group(app, session, "attempts", "Reported queries of planners, solved or not");
  add_attempt_list(*attempts, session);
  add_one(*attempts, session,
          {"show", "id", kAttemptId,
           "An attempt by its report's UUID: why it failed, what was in the way",
           std::string("kinship attempts show ") + kExampleAttempt},
          show_attempt);
  add_plot(*attempts, session,
           {"plot", "id", kAttemptId,
            "A page of an attempt in its scene: its path, or what was in the way",
            std::string("kinship attempts plot ") + kExampleAttempt + " --output attempt.html"},
           plot_attempt);
  add_problem_export(*attempts, session);
}

}  // namespace kinship::cli
