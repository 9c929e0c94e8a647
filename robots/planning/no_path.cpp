#include "robots/planning/no_path.hpp"

namespace kinship::planning {

std::string_view describe(NoPath reason) {
  switch (reason) {
    case NoPath::None:
      break;
    case NoPath::NoGoal:
      return "no goal";
    case NoPath::StartOutOfReach:
      return "start out of reach";
    case NoPath::StartBeyondLimits:
      return "start only reached outside the joint limits";
    case NoPath::StartNotFound:
      return "no inverse kinematics solution of the start found";
    case NoPath::GoalOutOfReach:
      return "goal out of reach";
    case NoPath::GoalBeyondLimits:
      return "goal only reached outside the joint limits";
    case NoPath::GoalNotFound:
      return "no inverse kinematics solution of the goal found";
    case NoPath::GoalOutsideBounds:
      return "outside the planning bounds";
    case NoPath::StartCollides:
      return "start collides";
    case NoPath::GoalsCollide:
      return "every goal collides";
    case NoPath::StartOffConstraint:
      return "start violates the constraint";
    case NoPath::GoalsOffConstraint:
      return "every goal violates the constraint";
    case NoPath::MaxChecks:
      return "collision checks used up";
    case NoPath::TimeLimit:
      return "time used up";
    case NoPath::GaveUp:
      return "the planner gave up";
    case NoPath::NothingRecalled:
      return "nothing to recall";
    case NoPath::RecallCollides:
      return "recalled path collides";
    case NoPath::EdgesRefuted:
      return "the paths found are not free between the configurations that were checked";
  }
  return "";
}

}  // namespace kinship::planning
