#include <functional>
#include <map>
#include <ostream>

#include "client/cli/session.hpp"
#include "client/link/admin_rows.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/manual/completion.hpp"
#include "proto/types/exit_code.hpp"
#include "proto/types/names.hpp"

namespace kinship::cli {
namespace {

struct Candidates {
  AdminVerb verb;
  std::function<std::string(const std::string& row)> word;
};

/// A row's word by `parse` and `word`; empty for a row that cannot be read.
template <typename Parse, typename Word>
std::function<std::string(const std::string& row)> word_of(Parse parse, Word word) {
  return [parse, word](const std::string& row) {
    const auto value = parse(row);
    return value ? std::string(std::invoke(word, *value)) : std::string();
  };
}

std::map<std::string, Candidates> all_candidates() {
  return {
      {"ROBOT",
       {AdminVerb::ListRobots, word_of(json::row_from_json<RobotSummary>, &RobotSummary::label)}},
      {"TASK",
       {AdminVerb::ListTasks, word_of(json::row_from_json<TaskSummary>, &TaskSummary::task)}},
      {"DISTRIBUTION",
       {AdminVerb::ListDistributions,
        word_of(json::row_from_json<DistributionSummary>,
                [](const DistributionSummary& row) { return row.id.short_hex(); })}},
      {"PATH",
       {AdminVerb::ListPaths,
        word_of(json::row_from_json<PathSummary>,
                [](const PathSummary& row) { return row.report_uuid.text(); })}},
      {"JOB", {AdminVerb::ListJobs, word_of(json::row_from_json<Job>, &Job::id)}},
  };
}

/// `candidates`, for completion scripts: the server's names that can complete a word, one per line,
/// the newest first; without an answer no output and no message.
/// \param kind  ROBOT, TASK, DISTRIBUTION, PATH or JOB (proto/manual/usage.hpp).
int print_candidates(link::Client& server, const std::string& kind, std::ostream& out) {
  constexpr std::size_t kMost = 200;  // a page of them
  const Candidates candidates = all_candidates().at(kind);
  std::string words;
  const auto error = link::for_each_row(
      server, {.verb = candidates.verb},
      [&](const std::string& row) {
        // Any peer may claim to be a server: a word on a command line is a name, and no program.
        if (const std::string word = candidates.word(row); !check_label(word))
          words += word + '\n';
        return true;
      },
      kMost);
  if (!error)
    out << words;
  return kDone;
}

void add_scripts(CLI::App& app, Session& session) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* command = add_command(
      app, "completion", "Print a script by which a shell completes words (as --completion)",
      "source <(kinship completion bash)        in ~/.bashrc\n"
      "  source <(kinship completion zsh)         in ~/.zshrc, after compinit\n"
      "  kinship completion fish | source         in ~/.config/fish/config.fish\n"
      "  source <(kinship-plan --completion bash) the other programs have the option");
  command->add_option("shell", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  on_run(*command, session, [&app, &session, shell] {
    session.out << manual::completion(manual::usage_of(app), *manual::shell_of(*shell));
    return kDone;
  });
}

/// Hidden: the shell waits for it at the press of a key.
void add_candidates(CLI::App& app, Session& session) {
  constexpr double kPatience_s = 0.3;
  const auto kind = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("candidates", "What a word could be, for completions");
  command->group("");
  command->add_option("kind", *kind, "What is wanted")
      ->required()
      ->check(CLI::IsMember({"ROBOT", "TASK", "DISTRIBUTION", "PATH", "JOB"}));
  on_run(*command, session, [&session, kind] {
    Session asking = session;
    asking.timeout_s = kPatience_s;
    try {
      return asking.with_server(
          [&](link::Client& server) { return print_candidates(server, *kind, session.out); });
    } catch (const std::exception&) {  // no network, no such host: no candidates
      return static_cast<int>(kDone);
    }
  });
}

}  // namespace

void add_completion(CLI::App& app, Session& session) {
  add_scripts(app, session);
  add_candidates(app, session);
}

}  // namespace kinship::cli
