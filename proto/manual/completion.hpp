#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/manual/usage.hpp"

namespace kinship::manual {

enum class Shell { Bash, Zsh, Fish };

std::optional<Shell> shell_of(std::string_view name);  ///< "bash", "zsh", "fish"

/// A script that completes the command line of a program: verbs, options, their values, and names
/// that a server knows (`kinship candidates`), if one answers at once.
std::string completion(const CommandUsage& program, Shell shell);

/// For the sources of this folder: parts of the three scripts.
namespace script {

/// Options of a command, its own and the inherited ones.
std::vector<const OptionUsage*> options_of(const CommandUsage& command);

/// Names of programs and of functions that complete them: "kinship_plan".
std::string function_name(const CommandUsage& program);

/// Within single quotes of a shell.
std::string shell_quoted(const std::string& text);

/// The first sentence or clause of a description, on one line, to show beside a candidate.
std::string short_description(const std::string& description);

/// The patterns "/paths/list --task" of all options that take a value, with '|' between them;
/// quoted for `case`.
std::string value_patterns(const CommandUsage& program);

/// The patterns "/paths/list" of all verbs, with '|' between them; one that never matches if there
/// are none.
std::string verb_patterns(const CommandUsage& program);

std::string bash_completion(const CommandUsage& program);
std::string zsh_completion(const CommandUsage& program);
std::string fish_completion(const CommandUsage& program);

}  // namespace script
}  // namespace kinship::manual
