#include <sstream>

#include "proto/manual/completion.hpp"

namespace kinship::manual::script {
namespace {

std::string zsh_action(const ValueUsage& value, const std::string& name) {
  switch (value.kind) {
    case ValueKind::Words: {
      std::string words;
      for (const std::string& word : value.words)
        words += " " + shell_quoted(word);
      return "compadd --" + words;
    }
    case ValueKind::File:
      return "_files";
    case ValueKind::Folder:
      return "_files -/";
    case ValueKind::FromServer:
      return "_" + name + "_server " + value.name;
    case ValueKind::Anything:
      break;
  }
  return "_message 'no completion'";
}

/// "name:description" of _describe.
std::string described(const std::string& name, const std::string& description) {
  return shell_quoted(name + ":" + short_description(description));
}

void write_values_of_zsh(const CommandUsage& program, const std::string& name, std::ostream& out) {
  out << "  case \"$at $previous\" in\n";
  for (const CommandUsage* const command : with_all_below(program))
    for (const OptionUsage* const option : options_of(*command)) {
      std::string patterns;
      for (const std::string& dashed : option->names)
        patterns += (patterns.empty() ? "" : "|") + shell_quoted(command->path + " " + dashed);
      if (option->takes_value && !patterns.empty())
        out << "    " << patterns << ") " << zsh_action(option->value, name) << "; return ;;\n";
    }
  out << "  esac\n";
}

void write_words_of_zsh(const CommandUsage& program, const std::string& name, std::ostream& out) {
  out << "  local -a found\n  if [[ $current == -* ]]; then\n    case $at in\n";
  for (const CommandUsage* const command : with_all_below(program)) {
    out << "      " << shell_quoted(command->path) << ") found=(";
    for (const OptionUsage* const option : options_of(*command))
      for (const std::string& dashed : option->names)
        out << " " << described(dashed, option->description);
    out << " ) ;;\n";
  }
  out << "    esac\n    _describe -o option found\n    return\n  fi\n"
      << "  case \"$at $arguments\" in\n";
  for (const CommandUsage* const command : with_all_below(program)) {
    if (!command->commands.empty()) {
      out << "    " << shell_quoted(command->path + " 0") << ") found=(";
      for (const CommandUsage& below : command->commands)
        out << " " << described(below.name, below.description);
      out << " ); _describe command found ;;\n";
    }
    for (std::size_t i = 0; i < command->arguments.size(); ++i)
      out << "    " << shell_quoted(command->path + " " + std::to_string(i)) << ") "
          << zsh_action(command->arguments[i].value, name) << " ;;\n";
  }
  out << "  esac\n";
}

}  // namespace

std::string zsh_completion(const CommandUsage& program) {
  const std::string name = function_name(program);
  std::ostringstream out;
  out << "#compdef " << program.name << "\n# Made from its command line.\n"
      << "# What the server knows that the line, or the environment, names; nothing without one.\n"
      << "_" << name << R"sh(_server() {
  local word before=
  local -a where known
  for word in "${(@)words[2,CURRENT-1]}"; do
    case $word in
      --server=*|--domain=*) where+=("${word%%=*}" "${word#*=}") ;;
    esac
    [[ $before == --server || $before == --domain ]] && where+=("$before" "$word")
    before=$word
  done
  known=(${(f)"$(kinship candidates "$1" "${(@)where}" 2>/dev/null)"})
  (( $#known )) && compadd -a known
}
_)sh" << name
      << R"sh(() {
  local current=${words[CURRENT]} previous=${words[CURRENT-1]}
  local at= skip= word
  local -i arguments=0 i
  if [[ $current == --*=* ]]; then
    previous=${current%%=*}
    compset -P '*='
  fi
  for ((i = 2; i < CURRENT; i++)); do
    word=${words[i]}
    if [[ -n $skip ]]; then
      skip=
      continue
    fi
    case "$at $word" in
      )sh"
      << value_patterns(program) << R"sh() skip=yes; continue ;;
      *' -'*) continue ;;
    esac
    case "$at/$word" in
      )sh"
      << verb_patterns(program) << R"sh() at=$at/$word; arguments=0 ;;
      *) arguments+=1 ;;
    esac
  done
)sh";
  write_values_of_zsh(program, name, out);
  write_words_of_zsh(program, name, out);
  out << "}\nif [[ $funcstack[1] == _" << program.name << " || $funcstack[1] == _" << name
      << " ]]; then\n  _" << name << " \"$@\"\nelse\n  compdef _" << name << " " << program.name
      << "\nfi\n";
  return out.str();
}

}  // namespace kinship::manual::script
