#pragma once

#include <Eigen/Core>

#include "robots/kinematics/chain.hpp"

namespace kinship::inverse {

/// Replaces each joint's value by the one that stands for all its +-2 pi copies: continuous joints
/// in (-pi, pi], revolute joints nearest mid-range, prismatic joints as they are.
/// \param q  dof, joint units; values outside a limit by rounding only (1e-9) are moved onto it.
/// \return   whether every joint is then within its limits.
bool normalize(const kinematics::Chain& chain, Eigen::Ref<Eigen::VectorXd> q);

/// Euclidean distance, 1 m = 1 rad; wrapped for continuous joints only, since a joint with limits
/// cannot take the short way across them.
double distance(const kinematics::Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& a,
                const Eigen::Ref<const Eigen::VectorXd>& b);

}  // namespace kinship::inverse
