#pragma once

#include <iosfwd>
#include <optional>

#include "robots/geometry/link_shapes.hpp"
#include "robots/models/robot_arguments.hpp"

namespace kinship::cli {

/// A robot's collision geometry: planning needs it, kinematics and the server do not.
/// \return empty if it cannot be known here, and says why on `err`; of a description that is no
///         chain nothing is said.
std::optional<geometry::RobotShapes> read_geometry(const char* command,
                                                   const models::RobotArguments& arguments,
                                                   const RobotDescription& description,
                                                   std::ostream& err);

}  // namespace kinship::cli
