#pragma once

#include <string_view>

namespace kinship::planning {

/// Why a query has no path.
enum class NoPath {
  None,  ///< it has one
  NoGoal,
  StartOutOfReach,    ///< a start pose, as inverse kinematics says
  StartBeyondLimits,  ///< a start pose reached only outside the joint limits
  StartNotFound,      ///< a start pose of which no configuration was found
  GoalOutOfReach,     ///< a goal pose, as inverse kinematics says
  GoalBeyondLimits,   ///< a goal pose reached only outside the joint limits
  GoalNotFound,       ///< a goal pose of which no configuration was found
  GoalOutsideBounds,  ///< of planning
  StartCollides,
  GoalsCollide,  ///< every one
  StartOffConstraint,
  GoalsOffConstraint,  ///< every one
  MaxChecks,           ///< the collision checks are used up
  TimeLimit,
  GaveUp,  ///< a planner of OMPL, before checks and time were used up
  NothingRecalled,
  RecallCollides,  ///< the path that was recalled
  EdgesRefuted     ///< what is free where it was asked about is not in between, however closely
};

/// For people, without what only the query knows: "every goal collides". Empty for None.
std::string_view describe(NoPath reason);

}  // namespace kinship::planning
