#include "proto/manual/manual.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstddef>
#include <set>
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

namespace {

/// The names of a command's options that take numbers, and of the commands below it.
void collect_number_options(const CLI::App& app, std::set<std::string>& names) {
  for (const CLI::Option* const option : app.get_options())
    if (option->get_type_name() == kNumbers)
      for (const std::string& name : option->get_lnames())
        names.insert("--" + name);
  for (const CLI::App* const below : app.get_subcommands([](const CLI::App*) { return true; }))
    collect_number_options(*below, names);
}

/// A number, or a list of them.
bool is_of_numbers(const std::string& word) {
  return word.find_first_of("0123456789") != std::string::npos &&
         word.find_first_not_of("0123456789+-.eE, \t") == std::string::npos;
}

void join_numbers(const CLI::App& app, std::vector<std::string>& words) {
  std::set<std::string> names;
  collect_number_options(app, names);
  std::vector<std::string> joined;
  bool is_list = false;  // the last word is one, of such an option
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool is_numbers = is_of_numbers(words[i]);
    if (is_list && is_numbers) {
      joined.back() += ' ' + words[i];
      continue;
    }
    is_list = is_numbers && i > 0 && names.contains(words[i - 1]);
    joined.push_back(words[i]);
  }
  words = std::move(joined);
}

}  // namespace

void parse(CLI::App& app, int argc, const char* const* argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words.front() == "help") {
    words.erase(words.begin());
    words.emplace_back("--help");
  } else if (words.size() == 1 && words.front() == "version") {
    words.front() = "--version";
  }
  join_numbers(app, words);
  std::ranges::reverse(words);  // as CLI11 takes them
  app.parse(std::move(words));
}

}  // namespace kinship::manual
