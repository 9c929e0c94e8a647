#pragma once

#include <iosfwd>
#include <string>

#include "proto/types/robot_description.hpp"

/// A robot's description for people.
namespace kinship::cli {

std::string axes_text(const TaskAxes& axes);  ///< "x y yaw"; "all" of them

/// The parts of a description that decide how experience is transferred to the robot: transfer
/// frame, task axes, held joints; one line each, values from the 13th column on.
void print_transfer(const RobotDescription& description, std::ostream& out);

}  // namespace kinship::cli
