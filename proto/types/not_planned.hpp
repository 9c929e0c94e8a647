#pragma once

#include "proto/types/enum_text.hpp"

namespace kinship {

/// Why no search was begun for a problem. The effort in its result is then not that of planning.
enum class NotPlanned {
  Unreadable,    ///< its line, or the file of a mesh
  DofMismatch,   ///< start or goal has another number of joints than the robot
  UnfitPlanner,  ///< cannot solve this kind of problem
  StartOutOfReach,
  StartBeyondLimits,  ///< of the joints
  StartNotFound,      ///< inverse kinematics found no configuration of its pose
  StartCollides,
  StartOffConstraint,
  GoalOutOfReach,
  GoalBeyondLimits,
  GoalNotFound,
  GoalCollides,  ///< in every configuration
  GoalOffConstraint,
  Error  ///< another error, given in the reason
};

template <>
struct Words<NotPlanned> {
  static constexpr std::string_view kWhat = "not_planned";
  static constexpr std::array<std::string_view, 14> kWords = {
      "unreadable",          "dof_mismatch",
      "unfit_planner",       "start_out_of_reach",
      "start_beyond_limits", "start_not_found",
      "start_collides",      "start_off_constraint",
      "goal_out_of_reach",   "goal_beyond_limits",
      "goal_not_found",      "goal_collides",
      "goal_off_constraint", "error"};
};

}  // namespace kinship
