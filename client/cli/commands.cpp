#include "client/cli/commands.hpp"

#include <CLI/CLI.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "client/arguments/command_options.hpp"
#include "client/arguments/number_range.hpp"
#include "client/cli/groups.hpp"
#include "proto/types/exit_code.hpp"

namespace kinship::cli {

int run(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  Session session{.out = out, .err = err};
  CLI::App app("The admin program of Kinship, an experience database for robot motion planning.",
               "kinship");
  app.footer(std::string(kExitCodes) +
             "Example:\n  kinship --domain 42 paths list --task box_to_shelf");
  app.require_subcommand(1);
  app.fallthrough();
  app.set_version_flag("--version", std::string("kinship ") + KINSHIP_VERSION);
  arguments::add_server_address(app, session.host, session.domain);
  app.add_option("--timeout", session.timeout_s, "Seconds to wait for an answer (default 5)")
      ->check(arguments::between(0.01, 86'400.0));
  add_server_commands(app, session);
  add_jobs(app, session);
  add_robots(app, session);
  add_problems(app, session);
  add_tasks(app, session);
  add_paths(app, session);
  add_distributions(app, session);
  add_configurations(app, session);
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
      err << "kinship: unknown command or argument '" << unknown.front() << "'"
          << arguments::suggestion_for(app, unknown.front()) << " (see: kinship --help)\n";
    return kWrongUsage;
  } catch (const CLI::ExtrasError& error) {
    app.exit(error, out, err);
    for (const std::string& word : app.remaining(true))
      if (const std::string near = arguments::suggestion_for(app, word); !near.empty())
        err << word << near << '\n';
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
