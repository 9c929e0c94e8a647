#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include "client/cli/job_commands.hpp"
#include "client/cli/plot_commands.hpp"
#include "client/link/client.hpp"

/// State that the groups of commands share, during and after parsing of the command line.
namespace kinship::cli {

struct Session {
  std::ostream& out;
  std::ostream& err;
  std::string host = link::ClientOptions().server;
  std::uint32_t domain = 0;
  std::filesystem::path security = {};  ///< folder of credentials; empty: none
  std::filesystem::path token = {};     ///< file of the server's token; empty: none
  double timeout_s = 5;
  bool json = false;
  std::vector<std::string> arguments = {};  ///< the command line, for a program that runs it again
  bool is_wide = false;                     ///< tables with every column
  bool is_verbose = false;                  ///< progress of long work also if `err` is no terminal
  std::function<int()> command = {};        ///< set by the subcommand that was named

  /// Runs a command that needs a server.
  int with_server(const std::function<int(link::Client&)>& use) const;

  /// Whether long work shows its progress on `err`: on a terminal, or on request.
  bool shows_progress() const;
};

std::chrono::milliseconds milliseconds(double seconds);

/// The commands about one noun, with its listings; its help names the exit codes, like the
/// program's.
CLI::App* add_group(CLI::App& app, Session& session, const std::string& name,
                    const std::string& what);

inline constexpr const char* kExitCodes =
    "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 not found, 4 no server answered.\n";

/// \param examples  one per line.
CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& what,
                      const std::string& examples);

/// --json, and -o, which also selects JSON or wide tables.
void add_json(CLI::App& command, Session& session,
              const std::string& what = "One JSON document on standard output");

/// --output of a command that writes a page. \return it.
CLI::Option* add_page_output(CLI::App& command, std::filesystem::path& output);

/// --since of a listing.
void add_since(CLI::App& command, std::string& since);
/// Unix time in ms of what --since was given; 0: nothing.
std::int64_t since_ms(const std::string& since);

/// Sets `run` to be run if the command line names the command.
template <typename Run>
void on_run(CLI::App& command, Session& session, Run run) {
  command.callback([&session, run] { session.command = run; });
}

/// The same for `run` with a server.
template <typename Run>
void on_run_with_server(CLI::App& command, Session& session, Run run) {
  on_run(command, session, [&session, run] { return session.with_server(run); });
}

using Show = int (*)(link::Client&, const std::string&, bool, std::ostream&, std::ostream&);

/// Texts of a command about one item.
struct OneText {
  std::string name;      ///< e.g. "show"
  std::string argument;  ///< its name in the usage line
  std::string meaning;   ///< of the argument
  std::string what;
  std::string example;
};

/// A command about one item, with --json. \return it, for further options.
CLI::App* add_one(CLI::App& group, Session& session, const OneText& text, Show show);

using Plot = int (*)(link::Client&, const std::string&, const PlotOptions&, std::ostream&,
                     std::ostream&);

/// A command that writes a page about one item.
void add_plot(CLI::App& group, Session& session, const OneText& text, Plot plot);

/// --wait of a command that waits for a job, a day by default.
/// \return gives the options of the wait, once the command line is parsed.
std::function<WaitOptions()> add_job_wait(CLI::App& command, const Session& session);

/// Writes on `err` what the outbox of the server keeps for stores that it had before.
void tell_of_older_reports(const Session& session, link::Client& server);

// The command line of each noun.
void add_server_commands(CLI::App& app,
                         Session& session);  ///< status, backup, watch, audit, console
void add_jobs(CLI::App& app, Session& session);
void add_robots(CLI::App& app, Session& session);
void add_problems(CLI::App& app, Session& session);
void add_schema(CLI::App& app, Session& session);
void add_results(CLI::App& app, Session& session);
void add_tasks(CLI::App& app, Session& session);
void add_paths(CLI::App& app, Session& session);
void add_attempts(CLI::App& app, Session& session);
void add_distributions(CLI::App& app, Session& session);
void add_configurations(CLI::App& app, Session& session);
void add_outbox(CLI::App& app, Session& session);
void add_completion(CLI::App& app, Session& session);  ///< completion and candidates

}  // namespace kinship::cli
