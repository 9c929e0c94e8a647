#include "client/cli/commands.hpp"

#include <CLI/CLI.hpp>
#include <optional>
#include <ostream>
#include <string>

#include "client/arguments/command_options.hpp"
#include "client/arguments/number_range.hpp"
#include "client/cli/session.hpp"
#include "client/cli/terminal.hpp"
#include "client/cli/wrapped_lines.hpp"
#include "proto/manual/manual.hpp"
#include "proto/manual/suggestion.hpp"
#include "proto/tables/table_layout.hpp"
#include "proto/types/exit_code.hpp"

namespace kinship::cli {

int run(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  Session session{.out = out, .err = err};
  session.arguments.assign(argv + 1, argv + argc);
  CLI::App app("The admin program of Kinship, an experience database for robot motion planning.",
               "kinship");
  manual::add_manual(app);
  app.footer(std::string(kExitCodes) +
             "Example:\n  kinship --domain 42 paths list --task box_to_shelf");
  app.require_subcommand(1);
  app.fallthrough();
  arguments::add_server_address(app, {session.host, session.domain, session.security});
  app.add_option("--token", session.token,
                 "file with a copy of the server's token, to change and remove at a server that "
                 "serves other hosts without security (kinshipd --token-file)")
      ->envname("KINSHIP_TOKEN")
      ->type_name("FILE");
  app.add_option("--timeout", session.timeout_s, "Seconds to wait for an answer (default 5)")
      ->check(arguments::between(0.01, 86'400.0))
      ->envname("KINSHIP_TIMEOUT");
  app.add_flag("--progress", session.is_verbose,
               "Tell on stderr how far long work is, also where that is no terminal");
  add_server_commands(app, session);
  add_jobs(app, session);
  add_robots(app, session);
  add_problems(app, session);
  add_results(app, session);
  add_schema(app, session);
  add_tasks(app, session);
  add_paths(app, session);
  add_attempts(app, session);
  add_distributions(app, session);
  add_configurations(app, session);
  add_outbox(app, session);
  add_completion(app, session);
  try {
    manual::parse(app, argc, argv);
    tables::TableLayout layout = tables::own_layout(out);
    layout.is_wide = session.is_wide;
    tables::set_table_layout(out, layout);
    const bool is_for_people = !session.json && !session.is_wide;
    std::optional<WrappedLines> wrapped_out, wrapped_err;
    if (is_for_people && is_terminal(out))
      wrapped_out.emplace(out, layout.width);
    if (is_for_people && is_terminal(err) && is_terminal(out))
      wrapped_err.emplace(err, layout.width);
    const int code = session.command();
    if (!out.flush()) {
      err << "kinship: cannot write to standard output\n";
      return kFailed;
    }
    return code;
  } catch (const CLI::ParseError& error) {
    return manual::explain(app, error, out, err);
  } catch (const Failure& failure) {
    err << "kinship: " << failure.what() << '\n';
    return exit_code(failure.code());
  } catch (const std::exception& error) {
    err << "kinship: " << error.what() << '\n';
    return kFailed;
  }
}

}  // namespace kinship::cli
