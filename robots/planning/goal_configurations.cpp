#include "robots/planning/goal_configurations.hpp"

#include "proto/types/split_mix.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/planning/planning_bounds.hpp"

namespace kinship::planning {
namespace {

NoPath reason_of(inverse::NoSolution reason) {
  switch (reason) {
    case inverse::NoSolution::OutOfReach:
      return NoPath::GoalOutOfReach;
    case inverse::NoSolution::Limits:
      return NoPath::GoalBeyondLimits;
    default:
      return NoPath::GoalNotFound;
  }
}

/// How often an arm is asked for further solutions as long as none of them is free.
constexpr int kMaxSearches = 10;

NoPath reason_of(const GoalConfigurations& goals, inverse::NoSolution why_none) {
  if (goals.found == 0)
    return reason_of(why_none);
  return goals.within_bounds == 0 ? NoPath::GoalOutsideBounds : NoPath::GoalsCollide;
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
  const std::vector<bool> turning = turning_joints(chain);

  const inverse::Solver solver(chain);
  GoalConfigurations goals;
  for (int searches = 1;; ++searches, search.seed += kSplitMixStep) {
    const inverse::InverseSolutions solutions = solver.solve(T_base_tip, search);
    const Eigen::Index found = solutions.configurations.cols();
    goals.found += static_cast<int>(found);
    goals.configurations.resize(chain.dof(), found);
    Eigen::Index kept = 0;
    for (const auto& solution : solutions.configurations.colwise()) {
      const auto q = turned_into(bounds, turning, solution);
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
    // Who gives fewer than were asked for has no others.
    if (found < options.max_configurations || searches == kMaxSearches) {
      goals.reason = reason_of(goals, solutions.reason);
      return goals;
    }
  }
}

}  // namespace kinship::planning
