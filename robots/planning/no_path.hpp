#pragma once

#include <string_view>

namespace kinship::planning {

/// Why a query has no path.
enum class NoPath {
  None,  ///< it has one
  NoGoal,
  StartOutOfReach,    ///< a start pose, by inverse kinematics
  StartBeyondLimits,  ///< a start pose reached only outside the joint limits
  StartNotFound,      ///< a start pose for which no configuration was found
  GoalOutOfReach,     ///< a goal pose, by inverse kinematics
  GoalBeyondLimits,   ///< a goal pose reached only outside the joint limits
  GoalNotFound,       ///< a goal pose for which no configuration was found
  GoalOutsideBounds,  ///< of planning
  StartCollides,
  GoalsCollide,  ///< every one
  StartOffConstraint,
  GoalsOffConstraint,  ///< every one
  MaxChecks,           ///< the collision checks are used up
  TimeLimit,
  GaveUp,  ///< a planner of OMPL, before checks and time were used up
  NothingRecalled,
  RecallCollides,  ///< the recalled path collides
  EdgesRefuted     ///< a line between free configurations is not free, even in the finest steps
};

/// For people, without details of the query: "every goal collides". Empty for None.
std::string_view describe(NoPath reason);

}  // namespace kinship::planning
