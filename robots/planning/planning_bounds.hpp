#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <vector>

#include "robots/kinematics/chain.hpp"

namespace kinship::planning {

inline constexpr double kTurn = 2 * M_PI;

/// The bounds of a plan from `start`: the joint limits, but for joints wider than a turn, including
/// continuous ones, only one turn, with the start in its middle or, near a limit, up to the limit.
/// So each posture exists once, in the turn nearest to the start: over several turns it exists many
/// times, and trees that meet in different turns do not meet.
/// \return 2 x dof: lower, upper, joint units.
/// \throws std::invalid_argument if start has another size than the chain or is not finite.
Eigen::Matrix2Xd planning_bounds(const kinematics::Chain& chain,
                                 const Eigen::Ref<const Eigen::VectorXd>& start);

/// Whether a full turn of each joint gives another configuration of the same posture, among which a
/// plan may have to choose: joints wider than a turn, including continuous ones.
std::vector<bool> turning_joints(const kinematics::Chain& chain);

/// The same posture within bounds: turning joints are moved by full turns.
/// \param bounds  2 x dof.
/// \return        empty if no turn of some joint lies within the bounds.
std::optional<Eigen::VectorXd> turned_into(const Eigen::Matrix2Xd& bounds,
                                           const std::vector<bool>& turning,
                                           const Eigen::Ref<const Eigen::VectorXd>& q);

/// Those of some configurations that have a turn within the bounds of a plan, moved there.
/// \param bounds, qs  2 x dof, dof x n. \return dof x m, m <= n.
Eigen::MatrixXd all_turned_into(const Eigen::Matrix2Xd& bounds, const kinematics::Chain& chain,
                                const Eigen::Ref<const Eigen::MatrixXd>& qs);

}  // namespace kinship::planning
