#pragma once

#include <Eigen/Core>

#include "server/transfer/arm_pair.hpp"
#include "server/transfer/transferred_path.hpp"

namespace kinship::transfer {

/// Maximum motion of a waypoint by the polish, Euclidean, 1 m = 1 rad.
inline constexpr double kFarthestPolish = 0.2;

/// Turns continuous joints into [-pi, pi]; a revolute joint outside its limits by whole turns into
/// them. Values within the limits are unchanged; values outside by at most inverse::kLimitRounding
/// are moved onto the limit. \return whether every joint is then within its limits.
bool bring_within(const kinematics::Chain& robot, Eigen::Ref<Eigen::VectorXd> q);

/// Waypoints of the same arm at the same place become configurations of the target robot, one each
/// at most. For exact arms: unchanged. For near ones: moved by one descent from the waypoint to the
/// exact pose of the transfer frame; not converged if that fails or ends farther than
/// kFarthestPolish from it. A waypoint that the target's limits forbid is counted outside_limits.
/// \param waypoints  dof x n, of the pair's source.
TransferredPath take_over(const Eigen::MatrixXd& waypoints, const ArmPair& pair);

}  // namespace kinship::transfer
