#pragma once

#include <string>
#include <vector>

namespace CLI {  // NOLINT: theirs
class App;
}

/// The command line of a program, read from its CLI11 tree: help, manual pages and completions are
/// made of this alone.
namespace kinship::manual {

/// Completions of the value of an option or argument.
enum class ValueKind {
  Anything,   ///< unknown
  Words,      ///< a fixed list
  File,       ///< type name FILE
  Folder,     ///< type name FOLDER
  FromServer  ///< type name ROBOT, TASK, DISTRIBUTION, PATH or JOB: names that a server knows
};

struct ValueUsage {
  ValueKind kind = ValueKind::Anything;
  std::string name;                ///< as help shows it: "FILE", "table|wide|json"
  std::vector<std::string> words;  ///< of ValueKind::Words
};

/// An option, or an argument, which has no names with dashes.
struct OptionUsage {
  std::vector<std::string> names;  ///< "--task", "-o"
  std::string argument;            ///< its name in the usage line; empty: an option with dashes
  std::string description;
  std::string environment;   ///< variable that may set it
  std::string default_text;  ///< its value if it is not given
  ValueUsage value;
  bool takes_value = false;
  bool is_required = false;
  bool is_repeatable = false;
};

struct CommandUsage {
  std::string name;
  std::string path;  ///< of verbs from the program on: "", "/paths", "/paths/list"
  std::string description;
  std::string footer;                  ///< notes, then "Example:" or "Examples:" and the examples
  std::vector<OptionUsage> options;    ///< its own
  std::vector<OptionUsage> inherited;  ///< of the commands above, if it accepts them too
  std::vector<OptionUsage> arguments;  ///< in their order
  std::vector<CommandUsage> commands;
};

/// Hidden commands and options (those of no group) are left out.
CommandUsage usage_of(const CLI::App& app);

/// The command and all its descendants, each before its own descendants.
std::vector<const CommandUsage*> with_all_below(const CommandUsage& command);

/// The value of an option, from its type name and checks.
/// \param type_name  as CLI11 puts it: "TEXT:{gmm,kde}", "FILE", "UINT:0 to 230".
ValueUsage value_usage(const std::string& type_name);

}  // namespace kinship::manual
