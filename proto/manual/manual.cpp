#include "proto/manual/manual.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "proto/manual/completion.hpp"
#include "proto/manual/help_text.hpp"
#include "proto/manual/man_page.hpp"

namespace kinship::manual {
namespace {

constexpr std::array<std::pair<const char*, int>, 4> kPrograms = {
    {{"kinship", 1}, {"kinship-experiments", 1}, {"kinship-plan", 1}, {"kinshipd", 8}}};

std::string others_than(const std::string& program) {
  std::string list;
  for (const auto& [name, section] : kPrograms)
    if (name != program)
      list += (list.empty() ? "" : ", ") + std::string(name) + "(" + std::to_string(section) + ")";
  return list;
}

/// Prints a text instead of running, as CLI11 does it for --version.
[[noreturn]] void print(std::string text) {
  text.erase(text.find_last_not_of('\n') + 1);
  throw CLI::CallForVersion(std::move(text), 0);
}

}  // namespace

void add_manual(CLI::App& app, int section) {
  constexpr const char* kGroup = "Manual";
  app.formatter(help_formatter());
  app.failure_message([](const CLI::App* program, const CLI::Error& error) {
    return program->get_name() + ": " + error.what() + " (see: " + program->get_name() +
           " --help)\n";
  });
  app.set_version_flag("--version", app.get_name() + " " + KINSHIP_VERSION);
  app.add_option_function<std::string>(
         "--completion",
         [&app](const std::string& shell) {
           print(completion(usage_of(app), shell_of(shell).value_or(Shell::Bash)));
         },
         "Print a script by which that shell completes this program's words, and end")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->configurable(false)
      ->group(kGroup);
  app.add_flag_callback(
         "--man-page",
         [&app, section] {
           print(man_page(usage_of(app),
                          {section, KINSHIP_VERSION, KINSHIP_DATE, others_than(app.get_name())}));
         },
         "Print the manual page, for man, and end")
      ->configurable(false)
      ->group(kGroup);
}

void parse(CLI::App& app, int argc, const char* const* argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words.front() == "help") {
    words.erase(words.begin());
    words.emplace_back("--help");
  } else if (words.size() == 1 && words.front() == "version") {
    words.front() = "--version";
  }
  std::ranges::reverse(words);  // as CLI11 takes them
  app.parse(std::move(words));
}

}  // namespace kinship::manual
