#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace CLI {  // NOLINT: theirs
class App;
}  // namespace CLI

namespace kinship::app {

/// The options of a parsed command line as a file that --config reads (TOML): one a line with what
/// it is for, its value, and where the value is from.
/// \param arguments  of the command line, by which what was said there is told from the file.
std::string configuration_text(const CLI::App& app, const std::vector<std::string>& arguments);

/// " (did you mean 'store'?)" with the option of `app` whose name is nearest to a misspelt one;
/// empty if none is near.
std::string suggestion(const CLI::App& app, std::string_view name);

}  // namespace kinship::app
