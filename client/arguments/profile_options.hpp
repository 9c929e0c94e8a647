#pragma once

#include <string>
#include <vector>

namespace CLI {  // NOLINT: theirs
class App;
class Option;
}  // namespace CLI

namespace kinship::arguments {

/// Adds --profile and --estimator; the latter is appended to what the former says, as the option of
/// a profile that it is.
/// \param profile  the default, and what is asked for once the command line is parsed; must outlive
///                 that.
/// \return both options.
std::vector<CLI::Option*> add_profile_options(CLI::App& app, std::string& profile);

}  // namespace kinship::arguments
