#pragma once

#include "proto/types/enum_text.hpp"

namespace kinship {

/// Why no search was begun for a problem. What its result says of effort tells nothing of planning.
enum class NotPlanned {
  Unreadable,    ///< its line, or the file of a mesh
  DofMismatch,   ///< start or goal have other joints than the robot
  UnfitPlanner,  ///< cannot do what the problem asks
  StartOutOfReach,
  StartBeyondLimits,  ///< of the joints
  StartNotFound,      ///< a pose of which inverse kinematics found no configuration
  StartCollides,
  StartOffConstraint,
  GoalOutOfReach,
  GoalBeyondLimits,
  GoalNotFound,
  GoalCollides,  ///< every configuration of it
  GoalOffConstraint,
  Error  ///< of another kind, which the reason says
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
