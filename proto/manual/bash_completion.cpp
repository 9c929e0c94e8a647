#include <sstream>

#include "proto/manual/completion.hpp"

namespace kinship::manual::script {
namespace {

/// The command that puts candidates for a value into COMPREPLY.
std::string bash_action(const ValueUsage& value) {
  switch (value.kind) {
    case ValueKind::Words: {
      std::string words;
      for (const std::string& word : value.words)
        words += (words.empty() ? "" : " ") + word;
      return "words " + shell_quoted(words);
    }
    case ValueKind::File:
      return "files";
    case ValueKind::Folder:
      return "folders";
    case ValueKind::FromServer:
      return "server " + value.name;
    case ValueKind::Anything:
      break;
  }
  return "nothing";
}

/// One helper for each kind of candidates; `current` is the word before the cursor.
void write_helpers(const std::string& name, std::ostream& out) {
  out << "_" << name << R"sh(_words() {
  local IFS=$'\n'
  COMPREPLY=($(compgen -W "${1// /$'\n'}" -- "$current"))
}
_)sh" << name
      << R"sh(_files() {
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen -f -- "$current")
}
_)sh" << name
      << R"sh(_folders() {
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen -d -- "$current")
}
# What the server knows that the line, or the environment, names; nothing without one.
_)sh" << name
      << R"sh(_server() {
  local word before= where=()
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    [[ $word == '=' ]] && continue
    [[ $before == --server || $before == --domain ]] && where+=("$before" "$word")
    before=$word
  done
  # compgen -W would expand what the server calls its robots
  while IFS= read -r word; do
    [[ $word == "$current"* ]] && COMPREPLY+=("$word")
  done < <(kinship candidates "$1" "${where[@]}" 2>/dev/null)
}
_)sh" << name
      << "_nothing() { COMPREPLY=(); }\n";
}

/// `case` with the completion of each option's value.
void write_values(const CommandUsage& program, const std::string& name, std::ostream& out) {
  out << "  case \"$path $previous\" in\n";
  for (const CommandUsage* const command : with_all_below(program))
    for (const OptionUsage* const option : options_of(*command)) {
      std::string patterns;
      for (const std::string& dashed : option->names)
        patterns += (patterns.empty() ? "" : "|") + shell_quoted(command->path + " " + dashed);
      if (option->takes_value && !patterns.empty())
        out << "    " << patterns << ") _" << name << "_" << bash_action(option->value)
            << "; return ;;\n";
    }
  out << "  esac\n";
}

/// `case` of the options, verbs and arguments of each command.
void write_words(const CommandUsage& program, const std::string& name, std::ostream& out) {
  out << "  if [[ $current == -* ]]; then\n    case $path in\n";
  for (const CommandUsage* const command : with_all_below(program)) {
    std::string options;
    for (const OptionUsage* const option : options_of(*command))
      for (const std::string& dashed : option->names)
        options += (options.empty() ? "" : " ") + dashed;
    out << "      " << shell_quoted(command->path) << ") _" << name << "_words "
        << shell_quoted(options) << " ;;\n";
  }
  out << "    esac\n    return\n  fi\n  case \"$path $arguments\" in\n";
  for (const CommandUsage* const command : with_all_below(program)) {
    std::string verbs;
    for (const CommandUsage& below : command->commands)
      verbs += (verbs.empty() ? "" : " ") + below.name;
    if (!verbs.empty())
      out << "    " << shell_quoted(command->path + " 0") << ") _" << name << "_words "
          << shell_quoted(verbs) << " ;;\n";
    for (std::size_t i = 0; i < command->arguments.size(); ++i)
      out << "    " << shell_quoted(command->path + " " + std::to_string(i)) << ") _" << name << "_"
          << bash_action(command->arguments[i].value) << " ;;\n";
  }
  out << "  esac\n";
}

}  // namespace

std::string bash_completion(const CommandUsage& program) {
  const std::string name = function_name(program);
  std::ostringstream out;
  out << "# bash completion for " << program.name << ", made from its command line\n";
  write_helpers(name, out);
  out << "_" << name << R"sh(() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}
  local path= arguments=0 skip= word i
  COMPREPLY=()
  # bash makes words of "--task=", "=" and what follows
  [[ $current == '=' ]] && current=
  [[ $previous == '=' ]] && previous=${COMP_WORDS[COMP_CWORD-2]}
  for ((i = 1; i < COMP_CWORD; i++)); do
    word=${COMP_WORDS[i]}
    [[ $word == '=' ]] && continue
    if [[ -n $skip ]]; then
      skip=
      continue
    fi
    case "$path $word" in
      )sh"
      << value_patterns(program) << R"sh() skip=yes; continue ;;
      *' -'*) continue ;;
    esac
    case "$path/$word" in
      )sh"
      << verb_patterns(program) << R"sh() path=$path/$word; arguments=0 ;;
      *) arguments=$((arguments + 1)) ;;
    esac
  done
)sh";
  write_values(program, name, out);
  write_words(program, name, out);
  out << "}\ncomplete -F _" << name << " " << program.name << "\n";
  return out.str();
}

}  // namespace kinship::manual::script
