#include "robots/planning/goal_configurations.hpp"

#include <algorithm>

#include "proto/types/split_mix.hpp"
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

/// Moves the free ones of the first `count` configurations to the front. \return how many.
Eigen::Index keep_free(const IsFree& is_free, Eigen::Index count, Eigen::MatrixXd& configurations) {
  Eigen::Index kept = 0;
  for (Eigen::Index first = 0; first < count;) {
    const Eigen::Index together = std::min(kFewTogether, count - first);
    const Eigen::Index free = is_free.ahead(configurations.middleCols(first, together));
    for (Eigen::Index i = first; i < first + free; ++i)
      configurations.col(kept++) = configurations.col(i);
    first += std::min(free + 1, together);
  }
  return kept;
}

}  // namespace

GoalConfigurations goal_configurations(const kinematics::Chain& chain,
                                       const Eigen::Isometry3d& T_base_goal,
                                       const Eigen::Matrix2Xd& bounds, const IsFree& is_free,
                                       const GoalOptions& options) {
  return goal_configurations(chain, inverse::Solver(chain), T_base_goal, bounds, is_free, options);
}

GoalConfigurations goal_configurations(const kinematics::Chain& chain,
                                       const inverse::Solver& solver,
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

  GoalConfigurations goals;
  for (int searches = 1;; ++searches, search.seed += kSplitMixStep) {
    const inverse::InverseSolutions solutions = solver.solve(T_base_tip, search);
    const Eigen::Index found = solutions.configurations.cols();
    goals.found += static_cast<int>(found);
    goals.configurations.resize(chain.dof(), found);
    Eigen::Index within = 0;
    for (const auto& solution : solutions.configurations.colwise())
      if (const auto q = turned_into(bounds, turning, solution))
        goals.configurations.col(within++) = *q;
    goals.within_bounds += static_cast<int>(within);
    goals.collision_checks += static_cast<std::uint64_t>(within);
    const Eigen::Index kept = keep_free(is_free, within, goals.configurations);
    goals.configurations.conservativeResize(Eigen::NoChange, kept);
    if (kept > 0)
      return goals;
    // A solver that gives fewer than were asked for has no others.
    if (found < options.max_configurations || searches == kMaxSearches) {
      goals.reason = reason_of(goals, solutions.reason);
      return goals;
    }
  }
}

}  // namespace kinship::planning
