#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "client/arguments/command_options.hpp"
#include "client/cli/path_export.hpp"
#include "client/cli/path_import.hpp"
#include "client/cli/session.hpp"
#include "client/cli/show_commands.hpp"
#include "client/cli/upkeep_commands.hpp"
#include "proto/types/exit_code.hpp"

namespace kinship::cli {
namespace {

constexpr const char* kYes = "Do it; without, it is only said what would happen (exit code 2)";

void add_export(CLI::App& group, Session& session) {
  constexpr std::size_t kMostPaths = 1'000'000'000;
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* command = add_command(
      group, "export", "Attempts and the robots they need, for `paths import` or a viewer",
      "kinship paths export --task box_to_shelf --output box_to_shelf.jsonl\n"
      "  kinship paths export --task box_to_shelf --limit 20 --mcap box_to_shelf.mcap\n"
      "  kinship paths export --task box_to_shelf --limit 20 --moveit trajectories/");
  CLI::Option* ids =
      command->add_option("id", options->ids, "Only these paths: UUIDs, as paths list shows them")
          ->type_name("PATH");
  command->add_option("--task", options->task, "Of this task (default: all)")
      ->type_name("TASK")
      ->excludes(ids);
  command->add_option("--robot", options->robot, "Of this robot: label or digest prefix")
      ->type_name("ROBOT")
      ->excludes(ids);
  command->add_option("--limit", options->limit, "Only the newest N paths that are in use")
      ->check(CLI::Range(std::size_t{1}, kMostPaths))
      ->excludes(ids);
  CLI::Option* output =
      command
          ->add_option("--output", options->output, "File of JSON Lines (default: standard output)")
          ->type_name("FILE");
  CLI::Option* mcap =
      command
          ->add_option(
              "--mcap", options->mcap,
              "Instead: a recording for Foxglove, in which the robots move along the paths at "
              "the speed limits of their URDFs; - is standard output")
          ->type_name("FILE")
          ->excludes(output);
  command
      ->add_option("--moveit", options->moveit,
                   "Instead: MoveIt's trajectories as YAML, with times by the speed limits of the "
                   "URDF: DisplayTrajectory documents in a file (- is standard output), or in a "
                   "folder (FOLDER/) a DisplayTrajectory and a RobotTrajectory for each path")
      ->type_name("FILE")
      ->excludes(output)
      ->excludes(mcap);
  on_run_with_server(*command, session, [&session, options](link::Client& server) {
    options->progress = session.shows_progress();
    return export_paths(server, *options, session.out, session.err);
  });
}

void add_import(CLI::App& group, Session& session) {
  const auto options = std::make_shared<ImportOptions>();
  CLI::App* command = add_command(
      group, "import",
      "Hand over an experience file, or what MoveIt or OMPL has kept; may be repeated",
      "kinship paths import box_to_shelf.jsonl\n  zcat old.jsonl.gz | kinship paths import -\n"
      "  kinship paths import --moveit-warehouse moveit.sqlite --robot panda --task box_to_shelf");
  CLI::Option* file = command->add_option("file", options->file, "JSON Lines; - is standard input")
                          ->type_name("FILE");
  CLI::Option* warehouse =
      command
          ->add_option("--moveit-warehouse", options->moveit_warehouse,
                       "Instead: a database of warehouse_ros_sqlite, the trajectories of MoveIt's "
                       "planning scenes and trajectory caches")
          ->type_name("FILE")
          ->excludes(file);
  CLI::Option* planner_data =
      command
          ->add_option("--ompl-planner-data", options->ompl_planner_data,
                       "Instead: a file of OMPL's PlannerDataStorage, the shortest ways of the "
                       "roadmap from its starts to its goals; only of a file that you trust")
          ->type_name("FILE")
          ->excludes(file)
          ->excludes(warehouse);
  CLI::Option* robot =
      command
          ->add_option("--robot", options->robot, "Whose joints these are: label or digest prefix")
          ->type_name("ROBOT")
          ->excludes(file);
  warehouse->needs(robot);
  planner_data->needs(robot);
  CLI::Option* task =
      command
          ->add_option("--task", options->task,
                       "Of these paths (default: the planning scene's or cache's name)")
          ->type_name("TASK")
          ->needs(robot);
  planner_data->needs(task);
  arguments::add_numbers(
      *command, "--placement", options->placement,
      "Base pose in the task frame (placement), \"x y z qx qy qz qw\" (default: the task frame "
      "is MoveIt's planning frame, for OMPL the base)")
      ->needs(robot);
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, options](link::Client& server) {
    options->json = session.json;
    options->progress = session.shows_progress();
    const int code = import_paths(server, *options, std::cin, session.out, session.err);
    tell_of_older_reports(session, server);
    return code;
  });
}

void add_experience(CLI::App& group, Session& session) {
  const auto options = std::make_shared<ExperienceOptions>();
  CLI::App* command =
      add_command(group, "experience",
                  "A task's end-effector paths (of the transfer frame) as planners get them",
                  "kinship tasks experience box_to_shelf\n"
                  "  kinship tasks experience box_to_shelf --json --max-bytes 1048576");
  command->add_option("task", options->task, "Its name")->required()->type_name("TASK");
  command->add_option("--max-bytes", options->max_bytes, "At most, 96 + 28 for each pose a path")
      ->check(CLI::Range(std::uint32_t{1}, kMaxExperienceBytes))
      ->capture_default_str();
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, options](link::Client& server) {
    options->json = session.json;
    return show_experience(server, *options, session.out, session.err);
  });
}

void add_retire(CLI::App& group, Session& session, const char* meaning,
                const std::string& example) {
  struct Options {
    std::string id;
    bool yes = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(group, "retire", "Take a path out of every fit; it is kept for the record",
                  "kinship paths retire " + example + " --yes");
  command->add_option("id", options->id, meaning)->required()->type_name("PATH");
  command->add_flag("--yes", options->yes, kYes);
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, options](link::Client& server) {
    return retire_path(server, options->id, options->yes, session.json, session.out, session.err);
  });
}

void add_restore(CLI::App& group, Session& session, const char* meaning,
                 const std::string& example) {
  const auto options = std::make_shared<RestoreOptions>();
  CLI::App* command = add_command(
      group, "restore",
      "Undo a retirement, or a reset: the paths are stored anew, under UUIDs of their own",
      "kinship paths restore " + example + "\n  kinship paths restore --task box_to_shelf");
  CLI::Option* id = command->add_option("id", options->id, meaning)->type_name("PATH");
  command->add_option("--task", options->task, "All retired ones of this task")
      ->type_name("TASK")
      ->excludes(id);
  command->add_option("--robot", options->robot, "Of this robot: label or digest prefix")
      ->type_name("ROBOT")
      ->excludes(id);
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, options](link::Client& server) {
    options->json = session.json;
    if (options->id.empty() && options->task.empty() && options->robot.empty()) {
      session.err << "paths restore: needs a path's UUID, --task or --robot\n";
      return static_cast<int>(kWrongUsage);
    }
    return restore_paths(server, *options, session.out, session.err);
  });
}

void add_task_upkeep(CLI::App& group, Session& session) {
  struct Options {
    std::string task, name;
    bool yes = false;
  };
  const auto add = [&](const std::string& verb, const std::string& what,
                       const std::string& examples) {
    const auto options = std::make_shared<Options>();
    CLI::App* command = add_command(group, verb, what, examples);
    command->add_option("task", options->task, "Its name")->required()->type_name("TASK");
    add_json(*command, session);
    return std::pair(command, options);
  };
  const auto [reset, to_reset] =
      add("reset", "Retire all paths of a task: out of every fit, kept for the record",
          "kinship tasks reset box_to_shelf\n  kinship tasks reset box_to_shelf --yes");
  reset->add_flag("--yes", to_reset->yes, kYes);
  on_run_with_server(*reset, session, [&session, options = to_reset](link::Client& server) {
    return reset_task(server, options->task, options->yes, session.json, session.out, session.err);
  });
  const auto [rename, to_rename] = add("rename", "Give a task another name, which no task has yet",
                                       "kinship tasks rename lod_machine load_machine");
  rename->add_option("name", to_rename->name, "New name, 1 to 128 of A-Z a-z 0-9 _ . : -")
      ->required();
  on_run_with_server(*rename, session, [&session, options = to_rename](link::Client& server) {
    return rename_task(server, options->task, options->name, session.json, session.out,
                       session.err);
  });
  const auto [remove, to_remove] =
      add("remove", "Retire all paths of a task and list it no more; its attempts stay on record",
          "kinship tasks remove lod_machine\n  kinship tasks remove lod_machine --yes");
  remove->add_flag("--yes", to_remove->yes, kYes);
  on_run_with_server(*remove, session, [&session, options = to_remove](link::Client& server) {
    return remove_task(server, options->task, options->yes, session.json, session.out, session.err);
  });
}

}  // namespace

void add_paths(CLI::App& app, Session& session) {
  constexpr const char* kId = "UUID of the report, or its first eight digits or more";
  constexpr const char* kExampleUuid = "7a0e3a52-8f0c-4d0a-9d43-2f6b7f0c1e55";
  CLI::App* paths = add_group(app, session, "paths", "Reported paths");
  add_one(*paths, session,
          {"show", "id", kId, "A path by its report's UUID",
           std::string("kinship paths show ") + kExampleUuid},
          show_path);
  add_plot(*paths, session,
           {"plot", "id", kId,
            "A page that shows a path in its scene: the arm along it, how near it comes to what",
            std::string("kinship paths plot ") + kExampleUuid + " --output path.html"},
           plot_path);
  add_export(*paths, session);
  add_import(*paths, session);
  add_retire(*paths, session, kId, kExampleUuid);
  add_restore(*paths, session, kId, kExampleUuid);
}

void add_tasks(CLI::App& app, Session& session) {
  CLI::App* tasks =
      add_group(app, session, "tasks", "Tasks and the robots that have experience of them");
  add_one(*tasks, session,
          {"show", "task", "Its name", "A task by name", "kinship tasks show box_to_shelf"},
          show_task);
  add_experience(*tasks, session);
  add_plot(
      *tasks, session,
      {"plot", "task", "Its name",
       "A page that shows a task's paths in space, and its experience and the benefit of guidance "
       "over time",
       "kinship tasks plot box_to_shelf --output box_to_shelf.html"},
      plot_task);
  add_task_upkeep(*tasks, session);
}

}  // namespace kinship::cli
