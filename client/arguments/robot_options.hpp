#pragma once

#include "robots/models/robot_arguments.hpp"

namespace CLI {  // NOLINT: theirs
class App;
}  // namespace CLI

namespace kinship::arguments {

/// Adds what a command line can say about a robot beside where it is: --base, --tip, --label,
/// --transfer, --axes, --hold, --srdf, --package. Where it is (`source`) is the program's to ask.
/// \param arguments  filled when the command line is parsed; must outlive that.
void add_robot_options(CLI::App& app, models::RobotArguments& arguments);

}  // namespace kinship::arguments
