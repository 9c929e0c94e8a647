#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "robots/kinematics/chain.hpp"

namespace kinship::fitting {

/// Where the circle of each continuous joint is cut, so that its angles can be treated as numbers:
/// per joint an angle in [-pi, pi), or empty for a joint that has limits.
using BranchCuts = std::vector<std::optional<double>>;

/// Cuts each continuous joint in the middle of the largest gap between its angles; if they are all
/// around the circle, that gap is small and neighbours across it are torn apart, but fewer than at
/// any other cut.
/// \param configurations  dof x N, N >= 1, finite.
/// \return dof entries, or none if no joint of the chain is continuous.
BranchCuts find_cuts(const kinematics::Chain& chain, const Eigen::MatrixXd& configurations);

/// Whether earlier cuts are still good: each in a gap between the angles that is at least half as
/// wide as the largest.
bool still_cuts(const BranchCuts& cuts, const kinematics::Chain& chain,
                const Eigen::MatrixXd& configurations);

/// Moves continuous joints by full turns into [cut, cut + 2 pi).
void wrap(const BranchCuts& cuts, Eigen::MatrixXd& configurations);

/// 2 x dof: the chain's limits, with [cut, cut + 2 pi] for continuous joints.
Eigen::Matrix2Xd limits_with(const BranchCuts& cuts, const kinematics::Chain& chain);

}  // namespace kinship::fitting
