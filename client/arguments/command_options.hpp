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

/// Options that several programs share.
namespace kinship::arguments {

/// Adds --profile and --estimator; the latter is appended to the profile, as one of its options.
/// \param profile  in: the default; out: the profile, once the command line is parsed; must outlive
///                 that.
/// \return both options.
std::vector<CLI::Option*> add_profile_options(CLI::App& app, std::string& profile);

/// Adds an option that takes numbers with blanks or commas between them, as one word or several:
/// `--q "0 0"`, `--q 0,0`, `--q 0 0`.
/// \param text  the numbers, for models::parse_numbers(), once the command line is parsed; must
///              outlive that.
CLI::Option* add_numbers(CLI::App& app, const std::string& name, std::string& text,
                         const std::string& description);

/// Adds the options of a robot except its files: --base, --tip, --label, --transfer, --axes,
/// --hold, --srdf, --package, --mesh-folder, --xacro-argument and those of drawn links. The program
/// itself adds `source`. \param arguments  filled when the command line is parsed; must outlive
/// that.
void add_robot_options(CLI::App& app, models::RobotArguments& arguments);

/// --without-meshes, of programs that register the robot.
void add_without_meshes(CLI::App& app, models::RobotArguments& arguments);

/// The address of a server, and the client's credentials.
struct ServerAddress {
  std::string& host;
  std::uint32_t& domain;
  std::filesystem::path& security;  ///< folder of credentials; empty: none
};

/// Adds --server, --domain and --security, which may also come from the environment:
/// KINSHIP_SERVER, KINSHIP_DOMAIN and KINSHIP_SECURITY.
/// \param address  in: the defaults; out: the values, once the command line is parsed; its
///                 references must outlive that.
void add_server_address(CLI::App& app, const ServerAddress& address);

/// Adds --sources, --weighting and --since. A malformed value is refused while the command line is
/// parsed. \param arguments  filled when the command line is parsed; must outlive that.
void add_selection_options(CLI::App& app, SelectionArguments& arguments);

}  // namespace kinship::arguments
