#pragma once

#include <string>
#include <string_view>

#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"

namespace kinship::json {

/// A robot description, in exports (`{"robot_description": ...}`) and `robots show`. `task_axes`
/// lists the names of the axes that matter.
std::string to_json(const RobotDescription& description);

/// \return the description, or InvalidInput or TooLarge that names field, value and limit. The URDF
///         text is not checked here, but by robots/kinematics.
Result<RobotDescription> robot_description_from_json(std::string_view text);

}  // namespace kinship::json
