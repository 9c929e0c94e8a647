#include "proto/manual/completion.hpp"

#include <algorithm>

namespace kinship::manual {

std::optional<Shell> shell_of(std::string_view name) {
  if (name == "bash")
    return Shell::Bash;
  if (name == "zsh")
    return Shell::Zsh;
  if (name == "fish")
    return Shell::Fish;
  return std::nullopt;
}

std::string completion(const CommandUsage& program, Shell shell) {
  switch (shell) {
    case Shell::Bash:
      return script::bash_completion(program);
    case Shell::Zsh:
      return script::zsh_completion(program);
    case Shell::Fish:
      return script::fish_completion(program);
  }
  return {};
}

namespace script {
namespace {

constexpr const char* kNeverMatches = "'no such verb or option'";

}  // namespace

std::vector<const OptionUsage*> options_of(const CommandUsage& command) {
  std::vector<const OptionUsage*> options;
  for (const auto* const list : {&command.options, &command.inherited})
    for (const OptionUsage& option : *list)
      options.push_back(&option);
  return options;
}

std::string function_name(const CommandUsage& program) {
  std::string name = program.name;
  std::ranges::replace(name, '-', '_');
  return name;
}

std::string shell_quoted(const std::string& text) {
  std::string in_quotes = "'";
  for (const char c : text)
    in_quotes += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return in_quotes + "'";
}

std::string short_description(const std::string& description) {
  constexpr std::size_t kMost = 60;
  std::string text = description.substr(0, description.find('\n'));
  for (const char* const end : {"; ", ": ", ". ", ", ", " ("})
    if (text.size() > kMost)
      text = text.substr(0, text.find(end));
  return text;
}

std::string value_patterns(const CommandUsage& program) {
  std::string patterns;
  for (const CommandUsage* const command : with_all_below(program))
    for (const OptionUsage* const option : options_of(*command))
      for (const std::string& name : option->names)
        if (option->takes_value)
          patterns += (patterns.empty() ? "" : "|") + shell_quoted(command->path + " " + name);
  return patterns.empty() ? kNeverMatches : patterns;
}

std::string verb_patterns(const CommandUsage& program) {
  std::string patterns;
  for (const CommandUsage* const command : with_all_below(program))
    if (!command->path.empty())
      patterns += (patterns.empty() ? "" : "|") + shell_quoted(command->path);
  return patterns.empty() ? kNeverMatches : patterns;
}

}  // namespace script
}  // namespace kinship::manual
