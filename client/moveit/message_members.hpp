#pragma once

#include "client/moveit/yaml_value.hpp"

namespace kinship::moveit {

/// Wants a document to have the shape of one of MoveIt's messages: maps and lists where it has
/// them, and no member that it does not have, so that a misspelt one does not vanish. Members that
/// are not looked at may hold anything, and each may be missing.
/// \param message  PlanningScene or MotionPlanRequest.
/// \throws Failure(InvalidInput) that names the place, and the member that may be meant.
void check_members(const YamlValue& document, const char* message);

}  // namespace kinship::moveit
