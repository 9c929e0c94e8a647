#pragma once

#include <iosfwd>

#include "robots/models/robot_arguments.hpp"

namespace kinship::cli {

/// Says on `err` what keeps a robot's collision geometry from being known here, if anything does:
/// planning needs it, kinematics and the server do not. Says nothing of a description that is no
/// chain.
void note_missing_geometry(const char* command, const models::RobotArguments& arguments,
                           const RobotDescription& description, std::ostream& err);

}  // namespace kinship::cli
