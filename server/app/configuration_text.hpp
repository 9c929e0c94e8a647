#pragma once

#include <string>
#include <vector>

namespace CLI {  // NOLINT: theirs
class App;
}  // namespace CLI

namespace kinship::app {

/// The options of a parsed command line as a file that --config reads (TOML): one per line with its
/// purpose, its value and the source of the value. Passwords are replaced by a note that they are
/// not shown.
/// \param arguments  of the command line; they tell its values from those of the file.
std::string configuration_text(const CLI::App& app, const std::vector<std::string>& arguments);

/// The long names of all options, without their dashes.
std::vector<std::string> option_names(const CLI::App& app);

}  // namespace kinship::app
