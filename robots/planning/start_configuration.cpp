#include "robots/planning/start_configuration.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/planning_bounds.hpp"

namespace kinship::planning {
namespace {

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
