#include "proto/manual/man_page.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <sstream>

#include "proto/manual/completion.hpp"

namespace kinship::manual {
namespace {

/// Text as roff takes it: no line of it is a request, no dash a hyphen, no backslash an escape.
std::string roff(const std::string& text) {
  std::string safe;
  bool begins_line = true;
  for (const char c : text) {
    if (begins_line && (c == '.' || c == '\''))
      safe += "\\&";
    if (c == '\\')
      safe += "\\e";
    else if (c == '-')
      safe += "\\-";
    else
      safe += c;
    begins_line = c == '\n';
  }
  return safe;
}

/// The same as an argument of a request, within its quotes.
std::string roff_argument(const std::string& text) {
  std::string safe;
  for (const char c : roff(text))
    safe += c == '"' ? std::string("\\(dq") : std::string(1, c);
  return "\"" + safe + "\"";
}

/// Notes up to the line that begins with "Example", and the lines after it.
std::pair<std::string, std::string> parts_of(const std::string& footer) {
  const std::size_t begin = footer.find("Example");
  const bool at_line = begin != std::string::npos && (begin == 0 || footer[begin - 1] == '\n');
  if (!at_line)
    return {footer, {}};
  const std::size_t colon = footer.find(':', begin);
  if (colon == std::string::npos)
    return {footer, {}};
  std::string examples = footer.substr(colon + 1);
  examples.erase(0, examples.find_first_not_of('\n'));
  return {footer.substr(0, begin), examples};
}

/// Lines of at most 80 bytes, at words; an empty one begins a paragraph.
void write_paragraph(const std::string& text, std::ostream& out) {
  constexpr std::size_t kMostBytes = 80;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string filled;
    for (std::string word; words >> word;) {
      word = roff(word);
      if (!filled.empty() && filled.size() + 1 + word.size() > kMostBytes) {
        out << filled << '\n';
        filled.clear();
      }
      filled += (filled.empty() ? "" : " ") + word;
    }
    out << (filled.empty() ? ".PP" : filled) << '\n';
  }
}

void write_examples(const std::string& examples, std::ostream& out) {
  if (examples.empty())
    return;
  out << "Examples:\n.PP\n.EX\n";
  std::istringstream lines(examples);
  for (std::string line; std::getline(lines, line);)
    out << roff(line) << '\n';
  out << ".EE\n";
}

/// \param heading  of a section, or a paragraph.
void write_notes(const std::string& footer, const std::string& heading, std::ostream& out) {
  const auto [notes, examples] = parts_of(footer);
  const std::size_t begin = notes.find_first_not_of('\n');
  if (begin != std::string::npos) {
    out << heading << '\n';
    write_paragraph(notes.substr(begin, notes.find_last_not_of('\n') + 1 - begin), out);
    out << (examples.empty() ? "" : ".PP\n");
  } else if (!examples.empty()) {
    out << heading << '\n';
  }
  write_examples(examples, out);
}

std::string usage_line(const CommandUsage& program, const CommandUsage& command) {
  std::string line = program.name + command.path;
  std::ranges::replace(line, '/', ' ');
  line += command.options.empty() ? "" : " [OPTIONS]";
  for (const OptionUsage& argument : command.arguments)
    line += " " + (argument.is_required ? argument.argument : "[" + argument.argument + "]");
  return line + (command.commands.empty() ? "" : " COMMAND");
}

void write_option(const OptionUsage& option, std::ostream& out) {
  std::string names;
  for (const std::string& name : option.names)
    names += (names.empty() ? "" : ", ") + name;
  out << ".TP\n.B " << roff_argument(names.empty() ? option.argument : names);
  if (option.takes_value && !names.empty())
    out << " " << roff_argument(option.value.name);
  out << '\n';
  std::string text = option.description;
  if (!option.default_text.empty())
    text += " (default: " + option.default_text + ")";
  if (!option.environment.empty())
    text += "; also from the environment, " + option.environment;
  if (text.empty())
    out << "\\&\n";
  else
    write_paragraph(text, out);
}

void write_options(const CommandUsage& command, std::ostream& out) {
  for (const OptionUsage& argument : command.arguments)
    if (argument.names.empty())
      write_option(argument, out);
  for (const OptionUsage& option : command.options)
    if (std::ranges::find(option.names, "--help") == option.names.end() || command.path.empty())
      write_option(option, out);
}

void write_commands(const CommandUsage& program, std::ostream& out) {
  if (program.commands.empty())
    return;
  out << ".SH COMMANDS\n";
  for (const CommandUsage* const command : with_all_below(program)) {
    if (command->path.empty() || !command->commands.empty())
      continue;
    out << ".SS " << roff_argument(usage_line(program, *command)) << '\n';
    write_paragraph(command->description, out);
    write_options(*command, out);
    write_notes(command->footer, ".PP", out);
  }
}

void write_environment(const CommandUsage& program, std::ostream& out) {
  std::map<std::string, std::string> variables;
  for (const CommandUsage* const command : with_all_below(program))
    for (const OptionUsage& option : command->options)
      if (!option.environment.empty())
        variables.emplace(option.environment, option.description);
  if (!variables.empty())
    out << ".SH ENVIRONMENT\n";
  for (const auto& [variable, meaning] : variables) {
    out << ".TP\n.B " << roff(variable) << '\n';
    write_paragraph(meaning, out);
  }
}

}  // namespace

std::string man_page(const CommandUsage& program, const ManPageFrame& frame) {
  std::ostringstream out;
  std::string title = program.name;
  std::ranges::transform(title, title.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  out << ".\\\" Made from the command line of " << program.name << ".\n"
      << ".TH " << roff_argument(title) << " " << frame.section << " " << ("\"" + frame.date + "\"")
      << " " << roff_argument("Kinship " + frame.version) << " \"Kinship\"\n.SH NAME\n";
  const std::string prefix = program.name + ": ";
  const std::string description = program.description.starts_with(prefix)
                                      ? program.description.substr(prefix.size())
                                      : program.description;
  out << roff(program.name) << " \\- " << roff(description) << "\n.SH SYNOPSIS\n.B "
      << roff_argument(usage_line(program, program)) << "\n.SH OPTIONS\n";
  write_options(program, out);
  write_commands(program, out);
  write_environment(program, out);
  write_notes(program.footer, ".SH NOTES", out);
  out << ".SH \"SEE ALSO\"\n" << roff(frame.see_also) << '\n';
  return out.str();
}

}  // namespace kinship::manual
