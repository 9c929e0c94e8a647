#pragma once

#include <string>
#include <vector>

namespace CLI {  // NOLINT: theirs
class App;
}

/// What a program's command line understands, read from its CLI11 tree: help, manual pages and
/// completions are made of this alone.
namespace kinship::manual {

/// What the value of an option or argument can be completed with.
enum class ValueKind {
  Anything,   ///< nobody knows
  Words,      ///< some of a few
  File,       ///< type name FILE
  Folder,     ///< type name FOLDER
  FromServer  ///< type name ROBOT, TASK, DISTRIBUTION, PATH or JOB: what a server knows
};

struct ValueUsage {
  ValueKind kind = ValueKind::Anything;
  std::string name;                ///< as help shows it: "FILE", "table|wide|json"
  std::vector<std::string> words;  ///< of ValueKind::Words
};

/// An option, or an argument, which has no names with dashes.
struct OptionUsage {
  std::vector<std::string> names;  ///< "--task", "-o"
  std::string argument;            ///< its name in the usage line; empty: it needs its dashes
  std::string description;
  std::string environment;   ///< variable that it may come from
  std::string default_text;  ///< its value if nothing is said
  ValueUsage value;
  bool takes_value = false;
  bool is_required = false;
  bool is_repeatable = false;
};

struct CommandUsage {
  std::string name;
  std::string path;  ///< of verbs from the program on: "", "/paths", "/paths/list"
  std::string description;
  std::string footer;                  ///< notes, then "Example:" or "Examples:" and these
  std::vector<OptionUsage> options;    ///< own ones
  std::vector<OptionUsage> inherited;  ///< of the commands above, where it takes these too
  std::vector<OptionUsage> arguments;  ///< in their order
  std::vector<CommandUsage> commands;
};

/// Hidden commands and options (those of no group) are left out.
CommandUsage usage_of(const CLI::App& app);

/// The command and all below it, each before those below it.
std::vector<const CommandUsage*> with_all_below(const CommandUsage& command);

/// What an option takes, by the type name and checks it was given.
/// \param type_name  as CLI11 puts it: "TEXT:{gmm,kde}", "FILE", "UINT:0 to 230".
ValueUsage value_usage(const std::string& type_name);

}  // namespace kinship::manual
