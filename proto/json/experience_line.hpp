#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "proto/json/attempt_json.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"

/// The lines of an experience file, `paths export` and `import`: first the robots it needs, then
/// attempts as attempt_json.hpp writes them.
namespace kinship::json {

using ExperienceLine = std::variant<RobotDescription, NamedAttempt>;

/// `{"robot_description": {...}}`
std::string to_experience_line(const RobotDescription& description);

/// \return the content of the line, or InvalidInput or TooLarge that names field, value and limit.
Result<ExperienceLine> experience_line_from_json(std::string_view text);

}  // namespace kinship::json
