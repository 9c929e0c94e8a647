#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "client/arguments/selection_arguments.hpp"
#include "robots/models/robot_arguments.hpp"

namespace CLI {  // NOLINT: theirs
class App;
class Option;
}  // namespace CLI

/// What several programs add to their command lines.
namespace kinship::arguments {

/// Adds --profile and --estimator; the latter is appended to what the former says, as the option of
/// a profile that it is.
/// \param profile  the default, and what is asked for once the command line is parsed; must outlive
///                 that.
/// \return both options.
std::vector<CLI::Option*> add_profile_options(CLI::App& app, std::string& profile);

/// Adds what a command line can say about a robot beside where it is: --base, --tip, --label,
/// --transfer, --axes, --hold, --srdf, --package. Where it is (`source`) is the program's to ask.
/// \param arguments  filled when the command line is parsed; must outlive that.
void add_robot_options(CLI::App& app, models::RobotArguments& arguments);

/// Where a server is, and as whom to talk to it.
struct ServerAddress {
  std::string& host;
  std::uint32_t& domain;
  std::filesystem::path& security;  ///< folder of credentials; empty: none
};

/// Adds --server, --domain and --security, which may also come from the environment:
/// KINSHIP_SERVER, KINSHIP_DOMAIN and KINSHIP_SECURITY. \param address  the defaults, and what is
/// asked for once the command line is parsed; what it refers to must outlive that.
void add_server_address(CLI::App& app, const ServerAddress& address);

/// Adds --sources, --weighting and --since. A malformed value is refused while the command line is
/// parsed. \param arguments  filled when the command line is parsed; must outlive that.
void add_selection_options(CLI::App& app, SelectionArguments& arguments);

}  // namespace kinship::arguments
