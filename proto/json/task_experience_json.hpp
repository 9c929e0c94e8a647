#pragma once

#include <string>

#include "proto/types/task_experience.hpp"

namespace kinship::json {

/// Output of `tasks experience`. The revision is text, 16 hexadecimal digits: as a number it would
/// not be exact in every language.
std::string to_json(const TaskExperience& experience);

}  // namespace kinship::json
