#include "client/cli/session.hpp"

#include <algorithm>
#include <cctype>

#include "client/arguments/number_range.hpp"
#include "client/arguments/selection_arguments.hpp"
#include "client/cli/listings.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/host_name.hpp"

namespace kinship::cli {

int Session::with_server(const std::function<int(link::Client&)>& use) const {
  if (const std::string why = link::why_unknown(host); !why.empty())
    throw Failure(ErrorCode::Unavailable, "--server '" + host + "': " + why);
  link::ClientOptions options;
  options.has_outbox = false;  // a look at a server delivers nothing to it
  options.server = host;
  options.domain = domain;
  options.timeout = milliseconds(timeout_s);
  options.security = security;
  options.token = token;
  link::Client server(options);
  if (const auto warning = server.expiry_warning())
    err << *warning << '\n';
  return use(server);
}

bool Session::shows_progress() const { return is_verbose || is_terminal(err); }

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::duration<double>(seconds));
}

CLI::App* add_group(CLI::App& app, Session& session, const std::string& name,
                    const std::string& what) {
  CLI::App* group = app.add_subcommand(name, what);
  group->footer(kExitCodes + ("Examples: kinship " + name) + " COMMAND --help");
  group->require_subcommand(1);
  add_listings(*group, session);
  return group;
}

CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& what,
                      const std::string& examples) {
  CLI::App* command = parent.add_subcommand(name, what);
  command->footer((examples.find('\n') == std::string::npos ? "Example:\n  " : "Examples:\n  ") +
                  examples);
  return command;
}

void add_json(CLI::App& command, Session& session, const std::string& what) {
  CLI::Option* const json = command.add_flag("--json", session.json, what);
  command
      .add_option_function<std::string>(
          "-o",
          [&session](const std::string& format) {
            session.json = format == "json";
            session.is_wide = format == "wide";
          },
          "table: what fits the terminal; wide: every column; json: as --json")
      ->check(CLI::IsMember({"table", "wide", "json"}))
      ->excludes(json);
}

void add_since(CLI::App& command, std::string& since) {
  command
      .add_option("--since", since,
                  "Only since a date or time in UTC (2026-11-21T05:32) or an age (90m, 14d)")
      ->check([](const std::string& text) {
        const auto time = arguments::parse_since(text, std::chrono::system_clock::now());
        return time ? std::string() : time.error().message;
      });
}

std::int64_t since_ms(const std::string& since) {
  return since.empty()
             ? 0
             : arguments::parse_since(since, std::chrono::system_clock::now()).value_or_throw();
}

CLI::Option* add_page_output(CLI::App& command, std::filesystem::path& output) {
  return command
      .add_option("--output", output, "HTML file, replaced once it is whole; - is standard output")
      ->type_name("FILE");
}

namespace {

/// The kind of value that an argument takes, for completions.
std::string kind_of(const CLI::App& group, const std::string& argument) {
  if (argument == "id" && group.get_name() == "attempts")
    return "ID";  // completion knows no name of those that failed
  if (argument == "id")
    return group.get_name() == "paths" ? "PATH" : "DISTRIBUTION";
  std::string kind = argument;
  std::ranges::transform(kind, kind.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return kind;
}

}  // namespace

CLI::App* add_one(CLI::App& group, Session& session, const OneText& text, Show show) {
  const auto argument = std::make_shared<std::string>();
  CLI::App* command = add_command(group, text.name, text.what, text.example);
  command->add_option(text.argument, *argument, text.meaning)
      ->required()
      ->type_name(kind_of(group, text.argument));
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, argument, show](link::Client& server) {
    return show(server, *argument, session.json, session.out, session.err);
  });
  return command;
}

void add_plot(CLI::App& group, Session& session, const OneText& text, Plot plot) {
  const auto argument = std::make_shared<std::string>();
  const auto options = std::make_shared<PlotOptions>();
  CLI::App* command = add_command(group, text.name, text.what, text.example);
  command->add_option(text.argument, *argument, text.meaning)
      ->required()
      ->type_name(kind_of(group, text.argument));
  add_page_output(*command, options->output)->required();
  on_run_with_server(*command, session, [&session, argument, options, plot](link::Client& server) {
    options->progress = session.shows_progress();
    return plot(server, *argument, *options, session.out, session.err);
  });
}

std::function<WaitOptions()> add_job_wait(CLI::App& command, const Session& session) {
  constexpr double kDay_s = 86'400;
  const auto wait_s = std::make_shared<double>(kDay_s);
  command.add_option("--wait", *wait_s, "Seconds to wait for its end (default: a day)")
      ->check(arguments::between(0.0, 30 * kDay_s));
  return [&session, wait_s] {
    return WaitOptions{milliseconds(*wait_s), session.shows_progress()};
  };
}

}  // namespace kinship::cli
