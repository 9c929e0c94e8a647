#include <sstream>

#include "proto/manual/completion.hpp"

namespace kinship::manual::script {
namespace {

/// Patterns of `case` in fish have spaces between them.
std::string with_spaces(const std::string& patterns) {
  std::string spaced;
  bool in_quotes = false;
  for (const char c : patterns) {
    if (c == '\'')
      in_quotes = !in_quotes;
    spaced += c == '|' && !in_quotes ? ' ' : c;
  }
  return spaced;
}

/// The candidates that `complete` is to offer for a value.
std::string fish_action(const ValueUsage& value, const std::string& name) {
  switch (value.kind) {
    case ValueKind::Words: {
      std::string words;
      for (const std::string& word : value.words)
        words += (words.empty() ? "" : " ") + word;
      return " -x -a " + shell_quoted(words);
    }
    case ValueKind::File:
      return " -r -F";
    case ValueKind::Folder:
      return " -x -a '(__fish_complete_directories)'";
    case ValueKind::FromServer:
      return " -x -a '(__" + name + "_server " + value.name + ")'";
    case ValueKind::Anything:
      break;
  }
  return " -x";
}

void write_command(const CommandUsage& program, const CommandUsage& command, std::ostream& out) {
  const std::string name = function_name(program);
  const std::string begin = "complete -c " + program.name + " -n ";
  for (const OptionUsage* const option : options_of(command)) {
    out << begin << shell_quoted("__" + name + "_at \"" + command.path + "\"");
    for (const std::string& dashed : option->names)
      out << (dashed.starts_with("--") ? " -l " + dashed.substr(2) : " -s " + dashed.substr(1));
    if (option->takes_value)
      out << fish_action(option->value, name);
    out << " -d " << shell_quoted(short_description(option->description)) << '\n';
  }
  const auto condition = [&](std::size_t arguments) {
    return shell_quoted("__" + name + "_at \"" + command.path + "\" " + std::to_string(arguments));
  };
  for (const CommandUsage& below : command.commands)
    out << begin << condition(0) << " -f -a " << shell_quoted(below.name) << " -d "
        << shell_quoted(short_description(below.description)) << '\n';
  for (std::size_t i = 0; i < command.arguments.size(); ++i) {
    const std::string action = fish_action(command.arguments[i].value, name);
    out << begin << condition(i)
        << (action == " -r -F" ? " -F" : " -f" + action.substr(std::string(" -x").size())) << '\n';
  }
}

}  // namespace

std::string fish_completion(const CommandUsage& program) {
  const std::string name = function_name(program);
  std::ostringstream out;
  out << "# fish completion for " << program.name << ", made from its command line\n"
      << "# Whether the verbs before the cursor are these, and so many arguments stand behind "
         "them.\n"
      << "function __" << name << R"sh(_at
    set -l path ''
    set -l arguments 0
    set -l skip no
    for word in (commandline -opc)[2..-1]
        if test $skip = yes
            set skip no
            continue
        end
        switch "$path $word"
            case )sh"
      << with_spaces(value_patterns(program)) << R"sh(
                set skip yes
                continue
            case '* -*'
                continue
        end
        switch "$path/$word"
            case )sh"
      << with_spaces(verb_patterns(program)) << R"sh(
                set path "$path/$word"
                set arguments 0
            case '*'
                set arguments (math $arguments + 1)
        end
    end
    test "$path" = "$argv[1]"; and begin
        test (count $argv) -lt 2; or test $arguments -eq $argv[2]
    end
end
# What the server knows that the line, or the environment, names; nothing without one.
function __)sh"
      << name << R"sh(_server
    set -l before ''
    set -l where
    for word in (commandline -opc)[2..-1]
        if contains -- $before --server --domain
            set -a where $before $word
        end
        if string match -q -r '^--(server|domain)=' -- $word
            set -a where $word
        end
        set before $word
    end
    kinship candidates $argv[1] $where 2>/dev/null
end
complete -c )sh"
      << program.name << " -f\n";
  for (const CommandUsage* const command : with_all_below(program))
    write_command(program, *command, out);
  return out.str();
}

}  // namespace kinship::manual::script
