#pragma once

#include "client/moveit/yaml_value.hpp"

namespace kinship::moveit {

/// Checks that a document has the structure of one of MoveIt's messages: maps and lists in the same
/// places, and no other members, so that a misspelt one is reported. Unused members may hold
/// anything, and each may be missing.
/// \param message  PlanningScene or MotionPlanRequest.
/// \throws Failure(InvalidInput) that names the place, and the likely member.
void check_members(const YamlValue& document, const char* message);

}  // namespace kinship::moveit
