#pragma once

#include <string>
#include <string_view>

#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"

namespace kinship::json {

/// What a client registers a robot with: in exports (`{"robot_description": ...}`) and `robots
/// show`. `task_axes` lists the names of those that matter.
std::string to_json(const RobotDescription& description);

/// \return the description, or InvalidInput or TooLarge that names field, value and limit. The
///         URDF text is taken as it is; robots/kinematics judges it.
Result<RobotDescription> robot_description_from_json(std::string_view text);

}  // namespace kinship::json
