#include "client/cli/groups.hpp"
#include "client/cli/listings.hpp"
#include "client/cli/retire_commands.hpp"

namespace kinship::cli {

void add_tasks(CLI::App& app, Session& session) {
  CLI::App* tasks = add_group(app, "tasks", "Tasks and the robots that have experience of them");
  add_list(*tasks, session, list_tasks);
  add_one(*tasks, session,
          {"show", "task", "Its name", "A task by name", "kinship tasks show box_to_shelf"},
          show_task);

  struct Options {
    std::string task;
    bool yes = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* reset = add_command(
      *tasks, "reset", "Retire all paths of a task: out of every fit, kept for the record",
      "kinship tasks reset box_to_shelf\n  kinship tasks reset box_to_shelf --yes");
  reset->add_option("task", options->task, "Its name")->required();
  reset->add_flag("--yes", options->yes,
                  "Do it; without, it is only said what would happen (exit code 2)");
  add_json(*reset, session);
  on_run_with_server(*reset, session, [&session, options](link::Client& server) {
    return reset_task(server, options->task, options->yes, session.json, session.out, session.err);
  });
}

}  // namespace kinship::cli
