#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "robots/inverse/solver.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/is_free.hpp"
#include "robots/planning/no_path.hpp"

namespace kinship::planning {

struct GoalOptions {
  int max_configurations = 20;  ///< all branches count: a single goal may lie behind an obstacle
  double min_distance = 0.3;    ///< between two of them, Euclidean, 1 m = 1 rad
  std::uint64_t seed = 0;
};

struct GoalConfigurations {
  Eigen::MatrixXd configurations;      ///< dof x n, n >= 0: free and within the bounds
  int found = 0;                       ///< by inverse kinematics, before bounds and collisions
  int within_bounds = 0;               ///< of `found`
  std::uint64_t collision_checks = 0;  ///< counted apart from the plan's
  NoPath reason = NoPath::None;        ///< why there are none
};

/// Goal configurations of a plan to a pose of the transfer frame. If none of `max_configurations`
/// is free, inverse kinematics of a redundant arm is repeated for others, up to ten times.
/// \param T_base_goal  pose of the transfer frame in the base link, m.
/// \param bounds       2 x dof (see planning_bounds); solutions are moved by full turns into them.
GoalConfigurations goal_configurations(const kinematics::Chain& chain,
                                       const Eigen::Isometry3d& T_base_goal,
                                       const Eigen::Matrix2Xd& bounds, const IsFree& is_free,
                                       const GoalOptions& options = {});

/// The same with an existing solver of the chain, for repeated calls.
GoalConfigurations goal_configurations(const kinematics::Chain& chain,
                                       const inverse::Solver& solver,
                                       const Eigen::Isometry3d& T_base_goal,
                                       const Eigen::Matrix2Xd& bounds, const IsFree& is_free,
                                       const GoalOptions& options = {});

struct StartConfiguration {
  std::optional<Eigen::VectorXd> q;    ///< dof
  std::uint64_t collision_checks = 0;  ///< counted apart from the plan's
  NoPath reason = NoPath::None;        ///< why there is none
};

/// The start of a plan from a pose of the transfer frame: of the pose's free configurations the one
/// nearest to a goal configuration (Euclidean, 1 m = 1 rad; joints wider than a turn the shorter
/// way round). Without goal configurations, the one nearest to the middle of the joint limits (in
/// parts of each joint's range; continuous joints do not count): the goal is then a pose too, and
/// the plan may end in any of its configurations. Equal arguments, equal answer.
/// \param T_base_start  pose of the transfer frame in the base link, m.
/// \param goals         dof x n, n >= 0.
StartConfiguration start_configuration(const kinematics::Chain& chain,
                                       const inverse::Solver& solver,
                                       const Eigen::Isometry3d& T_base_start,
                                       const Eigen::MatrixXd& goals, const IsFree& is_free);

}  // namespace kinship::planning
