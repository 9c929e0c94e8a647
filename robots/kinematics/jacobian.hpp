#pragma once

#include <Eigen/Core>

#include "robots/kinematics/chain.hpp"

namespace kinship::kinematics {

using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Geometric Jacobian of the tip link in the base link: 6 x dof, rows 0-2 linear velocity of the
/// tip's origin (m per joint unit), rows 3-5 angular velocity (rad per joint unit).
/// Source: Siciliano et al., Robotics (2009), eq. 3.30.
Jacobian J_base_tip(const Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& q);

}  // namespace kinship::kinematics
