#pragma once

#include <iosfwd>

#include "client/link/client.hpp"
#include "robots/models/robot_arguments.hpp"

namespace kinship::cli {

/// `robots register`: hands a robot's description to the server.
int register_robot(link::Client& server, const models::RobotArguments& arguments, bool json,
                   std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
