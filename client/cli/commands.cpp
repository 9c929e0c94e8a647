#include "client/cli/commands.hpp"

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <ostream>
#include <string>

#include "client/arguments/robot_options.hpp"
#include "client/cli/exit_code.hpp"
#include "client/cli/fetch_command.hpp"
#include "client/cli/inverse_commands.hpp"
#include "client/cli/listings.hpp"
#include "client/cli/register_command.hpp"

namespace kinship::cli {
namespace {

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::duration<double>(seconds));
}

/// What every command shares while the command line is being parsed and after.
struct Session {
  std::ostream& out;
  std::ostream& err;
  std::uint32_t domain = 0;
  double timeout_s = 5;
  bool json = false;
  std::function<int()> command = {};  ///< set by the subcommand that was named

  /// Runs a command that talks to a server.
  int with_server(const std::function<int(link::Client&)>& use) const {
    link::ClientOptions options;
    options.has_outbox = false;  // a look at a server delivers nothing to it
    options.domain = domain;
    options.timeout = milliseconds(timeout_s);
    link::Client server(options);
    return use(server);
  }
};

CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& what,
                      const std::string& examples) {
  CLI::App* command = parent.add_subcommand(name, what);
  command->footer("Example:\n  " + examples);
  return command;
}

void add_json(CLI::App& command, Session& session) {
  command.add_flag("--json", session.json, "One JSON document on standard output");
}

using List = int (*)(link::Client&, const ListOptions&, std::ostream&, std::ostream&);
using Show = int (*)(link::Client&, const std::string&, bool, std::ostream&, std::ostream&);

/// \param options  lives as long as the session.
CLI::App* add_list(CLI::App& group, Session& session, ListOptions& options, List list) {
  CLI::App* command = add_command(group, "list", "List " + group.get_name(),
                                  "kinship " + group.get_name() + " list --json");
  command->add_option("--limit", options.limit, "Rows at most (default: all)")
      ->check(CLI::NonNegativeNumber);
  add_json(*command, session);
  command->callback([&session, &options, list] {
    options.json = session.json;
    session.command = [&session, &options, list] {
      return session.with_server(
          [&](link::Client& server) { return list(server, options, session.out, session.err); });
    };
  });
  return command;
}

struct ShowText {
  std::string argument;  ///< its name in the usage line
  std::string what;
  std::string example;
};

/// \param argument  lives as long as the session.
void add_show(CLI::App& group, Session& session, std::string& argument, const ShowText& text,
              Show show) {
  CLI::App* command = add_command(group, "show", text.what, text.example);
  command->add_option(text.argument, argument)->required();
  add_json(*command, session);
  command->callback([&session, &argument, show] {
    session.command = [&session, &argument, show] {
      return session.with_server([&](link::Client& server) {
        return show(server, argument, session.json, session.out, session.err);
      });
    };
  });
}

void add_robot_arguments(CLI::App& command, models::RobotArguments& robot) {
  command
      .add_option("robot", robot.source, "URDF file, or a folder with chain.toml and robot.urdf")
      ->required();
  arguments::add_robot_options(command, robot);
}

/// The options of all commands; each lives as long as the parse and the run.
struct CommandOptions {
  ListOptions list;
  std::string shown;
  models::RobotArguments registered;
  CheckOptions check;
  InverseCommandOptions inverse;
  FetchOptions fetch;
  double wait_s = 30;
};

void add_status(CLI::App& app, Session& session) {
  CLI::App* command =
      add_command(app, "status", "Server, store, queues, counters", "kinship status --json");
  add_json(*command, session);
  command->callback([&session] {
    session.command = [&session] {
      return session.with_server([&](link::Client& server) {
        return show_status(server, session.json, session.out, session.err);
      });
    };
  });
}

void add_check(CLI::App& group, Session& session, CheckOptions& options) {
  CLI::App* command = add_command(group, "check", "What Kinship makes of a robot (no server)",
                                  "kinship robots check ur10e.urdf --base base_link --tip tool0");
  add_robot_arguments(*command, options.robot);
  command->add_option("--poses", options.poses, "Reachable poses to solve (default 200)")
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("--max-solutions", options.max_solutions, "A pose (default 8; 0: all)")
      ->check(CLI::Range(0, 1000));
  command->add_option("--min-distance", options.min_distance, "Between solutions (default 0.2)")
      ->check(CLI::Range(0.0, 100.0));
  command->add_option("--seed", options.seed, "Of the poses and solutions (default 0)")
      ->check(CLI::NonNegativeNumber);
  add_json(*command, session);
  command->callback([&session, &options] {
    options.json = session.json;
    session.command = [&session, &options] {
      return check_robot(options, session.out, session.err);
    };
  });
}

void add_inverse(CLI::App& group, Session& session, InverseCommandOptions& options) {
  CLI::App* command =
      add_command(group, "ik", "Inverse kinematics of the tip link's pose (no server)",
                  "kinship robots ik robots/models/ur10e --pose \"0.5 0.1 0.4 0 1 0 0\" --json");
  add_robot_arguments(*command, options.robot);
  CLI::Option_group* poses = command->add_option_group("poses");
  poses->add_option("--pose", options.pose, "Tip link in base link, \"x y z qx qy qz qw\"");
  poses->add_option("--poses", options.poses, "File with lines [x, y, z, qx, qy, qz, qw]");
  poses->require_option(1);
  command->add_option("--max-solutions", options.max_solutions, "Default 8; 0: all")
      ->check(CLI::Range(0, 1000));
  command->add_option("--min-distance", options.min_distance, "Between solutions (default 0.2)")
      ->check(CLI::Range(0.0, 100.0));
  command->add_option("--seed", options.seed, "Equal seed, equal solutions (default 0)")
      ->check(CLI::NonNegativeNumber);
  add_json(*command, session);
  command->callback([&session, &options] {
    options.json = session.json;
    session.command = [&session, &options] {
      return solve_poses(options, session.out, session.err);
    };
  });
}

void add_register(CLI::App& group, Session& session, models::RobotArguments& robot) {
  CLI::App* command =
      add_command(group, "register", "Hand a robot's description to the server",
                  "kinship robots register arm.urdf --base base_link --tip tool0 --label arm7");
  add_robot_arguments(*command, robot);
  add_json(*command, session);
  command->callback([&session, &robot] {
    session.command = [&session, &robot] {
      return session.with_server([&](link::Client& server) {
        return register_robot(server, robot, session.json, session.out, session.err);
      });
    };
  });
}

void add_fetch(CLI::App& group, Session& session, CommandOptions& options) {
  FetchOptions& fetch = options.fetch;
  CLI::App* command = add_command(
      group, "fetch", "A robot's distribution for a task, made if need be",
      "kinship distributions fetch --task box_to_shelf --robot ur10e --samples 1000 --csv");
  command->add_option("--task", fetch.task)->required();
  command->add_option("--robot", fetch.robot, "Label, or beginning of its digest")->required();
  command->add_option("--placement", fetch.placement,
                      "Robot's base in the task frame, \"x y z qx qy qz qw\"");
  command->add_option("--profile", fetch.profile, "default or paper");
  command->add_option("--wait", options.wait_s, "Seconds until it must be there (default 30)")
      ->check(CLI::Range(0.0, 3600.0));
  CLI::Option* samples = command->add_option("--samples", fetch.samples,
                                             "Draw so many configurations and print them as CSV");
  samples->check(CLI::Range(1.0, 1e9));
  command->add_flag("--csv")->description("The format of --samples")->needs(samples);
  command->add_option("--seed", fetch.seed, "Of the samples (default 0)")
      ->needs(samples)
      ->check(CLI::NonNegativeNumber);
  add_json(*command, session);
  command->callback([&session, &options] {
    options.fetch.wait = milliseconds(options.wait_s);
    options.fetch.json = session.json;
    session.command = [&session, &options] {
      return session.with_server([&](link::Client& server) {
        return fetch_distribution(server, options.fetch, session.out, session.err);
      });
    };
  });
}

CLI::App* add_group(CLI::App& app, const std::string& name, const std::string& what) {
  CLI::App* group = app.add_subcommand(name, what);
  group->require_subcommand(1);
  return group;
}

void add_commands(CLI::App& app, Session& session, CommandOptions& options) {
  add_status(app, session);

  CLI::App* robots = add_group(app, "robots", "Registered robots; inverse kinematics of any");
  add_list(*robots, session, options.list, list_robots);
  add_show(*robots, session, options.shown,
           {"robot", "A robot by label or beginning of its digest", "kinship robots show ur10e"},
           show_robot);
  add_register(*robots, session, options.registered);
  add_check(*robots, session, options.check);
  add_inverse(*robots, session, options.inverse);

  CLI::App* tasks = add_group(app, "tasks", "Tasks and the robots that have experience of them");
  add_list(*tasks, session, options.list, list_tasks);
  add_show(*tasks, session, options.shown,
           {"task", "A task by name", "kinship tasks show box_to_shelf"}, show_task);

  CLI::App* paths = add_group(app, "paths", "Reported paths");
  CLI::App* list = add_list(*paths, session, options.list, list_paths);
  list->add_option("--task", options.list.task, "Of this task");
  list->add_option("--robot", options.list.robot, "Of this robot: label or digest prefix");
  add_show(*paths, session, options.shown,
           {"id", "A path by its report's UUID",
            "kinship paths show 7a0e3a52-8f0c-4d0a-9d43-2f6b7f0c1e55"},
           show_path);

  CLI::App* distributions = add_group(app, "distributions", "Distributions made so far");
  list = add_list(*distributions, session, options.list, list_distributions);
  list->add_option("--task", options.list.task, "Of this task");
  list->add_option("--robot", options.list.robot, "Of this robot: label or digest prefix");
  add_show(*distributions, session, options.shown,
           {"id", "A distribution by beginning of its id", "kinship distributions show 3f9a0c"},
           show_distribution);
  add_fetch(*distributions, session, options);
}

}  // namespace

int run(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  Session session{.out = out, .err = err};
  CommandOptions options;
  CLI::App app("The admin program of Kinship, an experience database for robot motion planning.",
               "kinship");
  app.footer(
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 not found, 4 no server answered.\n"
      "Example:\n  kinship --domain 42 paths list --task box_to_shelf");
  app.require_subcommand(1);
  app.fallthrough();
  app.set_version_flag("--version", std::string("kinship ") + KINSHIP_VERSION);
  app.add_option("--domain", session.domain, "DDS domain (default 0)")
      ->envname("KINSHIP_DOMAIN")
      ->check(CLI::Range(0, 230));
  app.add_option("--timeout", session.timeout_s, "Seconds to wait for an answer (default 5)")
      ->check(CLI::Range(0.01, 86'400.0));
  add_commands(app, session, options);
  try {
    app.parse(argc, argv);
    const int code = session.command();
    if (!out.flush()) {
      err << "kinship: cannot write to standard output\n";
      return kFailed;
    }
    return code;
  } catch (const CLI::RequiredError& error) {
    const std::vector<std::string> unknown = app.remaining(true);
    if (unknown.empty())
      app.exit(error, out, err);
    else
      err << "kinship: unknown command or argument '" << unknown.front()
          << "' (see: kinship --help)\n";
    return kWrongUsage;
  } catch (const CLI::ParseError& error) {
    return app.exit(error, out, err) == 0 ? kDone : kWrongUsage;
  } catch (const Failure& failure) {
    err << "kinship: " << failure.what() << '\n';
    return exit_code(failure.code());
  } catch (const std::exception& error) {
    err << "kinship: " << error.what() << '\n';
    return kFailed;
  }
}

}  // namespace kinship::cli
