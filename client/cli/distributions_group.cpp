#include "client/arguments/command_options.hpp"
#include "client/arguments/number_range.hpp"
#include "client/cli/distribution_commands.hpp"
#include "client/cli/exchange_commands.hpp"
#include "client/cli/plot_commands.hpp"
#include "client/cli/session.hpp"
#include "client/cli/show_commands.hpp"
#include "client/cli/upkeep_commands.hpp"

namespace kinship::cli {
namespace {

/// The query that a distribution answers. \return the required options.
std::vector<CLI::Option*> add_query(CLI::App& command, DistributionQuery& query) {
  CLI::Option* task = command.add_option("--task", query.task, "Task whose experience is wanted")
                          ->type_name("TASK");
  CLI::Option* robot =
      command.add_option("--robot", query.robot, "Label, or beginning of its digest")
          ->type_name("ROBOT");
  arguments::add_numbers(
      command, "--placement", query.placement,
      "Base pose in the task frame (placement), \"x y z qx qy qz qw\" (default: as the robot "
      "last reported the task)");
  arguments::add_profile_options(command, query.profile);
  arguments::add_selection_options(command, query.selection);
  command
      .add_option_function<double>(
          "--wait", [&query](double wait_s) { query.wait = milliseconds(wait_s); },
          "Seconds until it must be there (default 30)")
      ->check(arguments::between(0.0, 3600.0));
  return {task, robot};
}

/// The same, or its id.
/// \param id_names  of the option, e.g. "--distribution".
void add_query_or_id(CLI::App& command, DistributionQuery& query, const std::string& id_names) {
  CLI::Option* id =
      command.add_option(id_names, query.id, "Beginning of its id, instead of --task and --robot")
          ->type_name("DISTRIBUTION");
  for (CLI::Option* option : add_query(command, query))
    option->excludes(id);
  command.parse_complete_callback([&query, id] {
    if (query.id.empty() && (query.task.empty() || query.robot.empty()))
      throw CLI::ValidationError("give --task and --robot, or " + id->get_name());
  });
}

void add_fetch(CLI::App& group, Session& session) {
  const auto options = std::make_shared<FetchOptions>();
  CLI::App* command = add_command(
      group, "fetch", "A robot's distribution for a task, computed if needed",
      "kinship distributions fetch --task box_to_shelf --robot ur10e --placement '0.2 -0.1 0 0 0 0 "
      "1' --samples 1000 --csv\n"
      "  kinship distributions fetch --task box_to_shelf --robot ur10e --sources panda --since "
      "14d");
  for (CLI::Option* option : add_query(*command, options->query))
    option->required();
  CLI::Option* samples = command->add_option("--samples", options->samples,
                                             "Draw so many configurations and print them as CSV");
  samples->check(arguments::between<std::uint64_t>(1, 1'000'000'000));
  command->add_flag("--csv")
      ->description("The format of --samples; it has no other")
      ->needs(samples);
  command->add_option("--seed", options->seed, "Of the samples (default 0)")
      ->needs(samples)
      ->check(CLI::NonNegativeNumber);
  add_json(*command, session);
  for (const char* const format : {"--json", "-o"})
    command->get_option(format)->excludes(samples);
  on_run_with_server(*command, session, [&session, options](link::Client& server) {
    options->json = session.json;
    return fetch_distribution(server, *options, session.out, session.err);
  });
}

void add_explain(CLI::App& group, Session& session) {
  const auto query = std::make_shared<DistributionQuery>();
  CLI::App* command = add_command(
      group, "explain", "What a distribution is made of, why it failed, how far it is behind",
      "kinship distributions explain --task box_to_shelf --robot ur10e --placement '0.2 -0.1 0 0 0 "
      "0 1'\n"
      "  kinship distributions explain --distribution 3f9a0c");
  add_query_or_id(*command, *query, "--distribution");
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, query](link::Client& server) {
    return explain_distribution(server, *query, session.json, session.out, session.err);
  });
}

void add_distribution_plot(CLI::App& group, Session& session) {
  const auto query = std::make_shared<DistributionQuery>();
  const auto options = std::make_shared<PlotOptions>();
  CLI::App* command = add_command(
      group, "plot", "A page of a distribution over its robot: lost poses, joints, sources",
      "kinship distributions plot --task box_to_shelf --robot ur10e --placement '0.2 -0.1 0 0 0 0 "
      "1' --output ur10e.html\n"
      "  kinship distributions plot 3f9a0c --output - > ur10e.html");
  add_query_or_id(*command, *query, "id");
  add_page_output(*command, options->output)->required();
  on_run_with_server(*command, session, [&session, query, options](link::Client& server) {
    options->progress = session.shows_progress();
    return plot_distribution(server, *query, *options, session.out, session.err);
  });
}

}  // namespace

void add_distributions(CLI::App& app, Session& session) {
  CLI::App* group = add_group(app, session, "distributions", "Distributions made so far");
  add_one(*group, session,
          {"show", "id", "Four digits of it or more", "A distribution by beginning of its id",
           "kinship distributions show 3f9a0c"},
          show_distribution);
  add_fetch(*group, session);
  add_explain(*group, session);
  add_distribution_plot(*group, session);
  add_one(*group, session,
          {"evict", "id", "Four digits of it or more",
           "Delete a distribution; the next fetch computes it again",
           "kinship distributions evict 3f9a0c"},
          evict_distribution);
}

void add_configurations(CLI::App& app, Session& session) {
  CLI::App* group = add_group(app, session, "configurations", "What distributions are fitted to");
  const auto options = std::make_shared<ConfigurationsOptions>();
  CLI::App* command = add_command(
      *group, "export", "Exactly the rows that a distribution's fit saw, as CSV",
      "kinship configurations export --task box_to_shelf --robot ur10e --placement '0.2 -0.1 0 0 0 "
      "0 1' --output rows.csv\n"
      "  kinship configurations export --distribution 3f9a0c");
  add_query_or_id(*command, options->query, "--distribution");
  command->add_option("--output", options->output, "File (default: standard output)")
      ->type_name("FILE");
  on_run_with_server(*command, session, [&session, options](link::Client& server) {
    options->waiting.progress = session.shows_progress();
    return export_configurations(server, *options, session.out, session.err);
  });
}

}  // namespace kinship::cli
