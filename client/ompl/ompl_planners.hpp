#pragma once

#include <ompl/base/Planner.h>

#include <string>

/// OMPL's planners by name; for this library's sources only.
namespace kinship::ompl_planners {

/// \param range  of planners that extend, joint units; 0: OMPL's choice.
/// \throws std::invalid_argument with all names for an unknown one, or if the range is negative.
ompl::base::PlannerPtr make_ompl_planner(const std::string& name, double range,
                                         const ompl::base::SpaceInformationPtr& information);

}  // namespace kinship::ompl_planners
