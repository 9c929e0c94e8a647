#include "robots/planning/goal_configurations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

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

/// The middle of the limits, 0 of a continuous joint.
Eigen::VectorXd middle_of(const kinematics::Chain& chain) {
  Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
  for (Eigen::Index i = 0; i < chain.dof(); ++i)
    if (chain.joints()[static_cast<std::size_t>(i)].type == kinematics::JointType::Continuous)
      middle[i] = 0;
  return middle;
}

/// Squared, in parts of the ranges.
double distance_to_middle(const kinematics::Chain& chain, const Eigen::VectorXd& middle,
                          const Eigen::Ref<const Eigen::VectorXd>& q) {
  double sum = 0;
  for (Eigen::Index i = 0; i < chain.dof(); ++i) {
    const kinematics::Joint& joint = chain.joints()[static_cast<std::size_t>(i)];
    const double range = joint.upper - joint.lower;
    if (joint.type != kinematics::JointType::Continuous && range > 0)
      sum += std::pow((q[i] - middle[i]) / range, 2);
  }
  return sum;
}

/// Squared, to the nearest goal.
double distance_to_goals(const std::vector<bool>& turning, const Eigen::MatrixXd& goals,
                         const Eigen::Ref<const Eigen::VectorXd>& q) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& goal : goals.colwise()) {
    Eigen::VectorXd way = goal - q;
    for (Eigen::Index i = 0; i < way.size(); ++i)
      if (turning[static_cast<std::size_t>(i)])
        way[i] = std::remainder(way[i], kTurn);
    least = std::min(least, way.squaredNorm());
  }
  return least;
}

/// The same of a start. \param reason  why a pose has no configurations.
NoPath of_start(NoPath reason) {
  switch (reason) {
    case NoPath::GoalOutOfReach:
      return NoPath::StartOutOfReach;
    case NoPath::GoalBeyondLimits:
    case NoPath::GoalOutsideBounds:
      return NoPath::StartBeyondLimits;
    case NoPath::GoalsCollide:
      return NoPath::StartCollides;
    default:
      return NoPath::StartNotFound;
  }
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

StartConfiguration start_configuration(const kinematics::Chain& chain,
                                       const inverse::Solver& solver,
                                       const Eigen::Isometry3d& T_base_start,
                                       const Eigen::MatrixXd& goals, const IsFree& is_free) {
  const Eigen::VectorXd middle = middle_of(chain);
  const std::vector<bool> turning = turning_joints(chain);
  // A seed of its own: planned with other seeds, the problem stays the same.
  const GoalConfigurations found =
      goal_configurations(chain, solver, T_base_start, planning_bounds(chain, middle), is_free);
  StartConfiguration start;
  start.collision_checks = found.collision_checks;
  if (found.configurations.cols() == 0)
    start.reason = of_start(found.reason);
  double least = std::numeric_limits<double>::infinity();
  for (const auto& q : found.configurations.colwise()) {
    const double distance = goals.cols() > 0 ? distance_to_goals(turning, goals, q)
                                             : distance_to_middle(chain, middle, q);
    if (distance < least) {
      least = distance;
      start.q = q;
    }
  }
  return start;
}

}  // namespace kinship::planning
