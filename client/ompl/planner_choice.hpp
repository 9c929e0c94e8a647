#pragma once

#include <string_view>

#include "client/guided/planner_choice.hpp"
#include "proto/types/result.hpp"

namespace kinship::ompl_planners {

/// As guided::parse_planner, and "ompl:NAME" with one of ompl_planner_names().
/// \return InvalidInput that shows the text and the valid names.
Result<guided::PlannerChoice> parse_planner(std::string_view text);

}  // namespace kinship::ompl_planners
