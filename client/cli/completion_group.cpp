#include "client/cli/complete_command.hpp"
#include "client/cli/groups.hpp"
#include "proto/manual/completion.hpp"

namespace kinship::cli {
namespace {

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
