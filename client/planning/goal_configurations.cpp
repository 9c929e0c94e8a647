#include "client/planning/goal_configurations.hpp"

#include "client/planning/planning_bounds.hpp"
#include "robots/inverse/inverse.hpp"

namespace kinship::planning {
namespace {

std::string in_words(inverse::NoSolution reason) {
  switch (reason) {
    case inverse::NoSolution::OutOfReach:
      return "goal out of reach";
    case inverse::NoSolution::Limits:
      return "goal only reached outside the joint limits";
    default:
      return "no inverse kinematics solution of the goal found";
  }
}

}  // namespace

GoalConfigurations goal_configurations(const kinematics::Chain& chain,
                                       const Eigen::Isometry3d& T_base_goal,
                                       const Eigen::Matrix2Xd& bounds, const IsFree& is_free,
                                       const GoalOptions& options) {
  inverse::InverseOptions search;
  search.max_solutions = options.max_configurations;
  search.min_distance = options.min_distance;
  search.seed = options.seed;
  const Eigen::Isometry3d T_base_tip =
      T_base_goal * chain.T_tip_transfer().inverse(Eigen::Isometry);
  const inverse::InverseSolutions solutions = inverse::inverse(chain, T_base_tip, search);

  GoalConfigurations goals;
  goals.found = static_cast<int>(solutions.configurations.cols());
  goals.configurations.resize(chain.dof(), goals.found);
  const std::vector<bool> turning = turning_joints(chain);
  Eigen::Index kept = 0;
  for (int i = 0; i < goals.found; ++i) {
    const auto q = turned_into(bounds, turning, solutions.configurations.col(i));
    if (!q)
      continue;
    ++goals.within_bounds;
    ++goals.collision_checks;
    if (is_free(*q))
      goals.configurations.col(kept++) = *q;
  }
  goals.configurations.conservativeResize(Eigen::NoChange, kept);
  if (kept > 0)
    return goals;
  if (goals.found == 0)
    goals.reason = in_words(solutions.reason);
  else
    goals.reason = goals.within_bounds == 0 ? "outside the planning bounds" : "every goal collides";
  return goals;
}

}  // namespace kinship::planning
