#pragma once

#include "robots/kinematics/chain.hpp"
#include "robots/kinematics/jacobian.hpp"

namespace kinship::inverse {

/// Jacobian of the transfer frame in the base link, m and rad per joint unit; rows of task axes
/// that do not matter are 0.
kinematics::Jacobian task_jacobian(const kinematics::Chain& chain,
                                   const Eigen::Ref<const Eigen::VectorXd>& q);

/// In how many independent directions of the task axes that matter the joints move the transfer
/// frame, at the best of a few random configurations within limits. Directions that a step of the
/// descent does not see, or that rounding in a model file has made, do not count.
Eigen::Index task_rank(const kinematics::Chain& chain);

/// Whether some motion of the joints leaves the pose as it is: there are more of them than
/// directions that they move the transfer frame in. Six joints of which two telescopes slide side
/// by side are redundant, five turning ones in general are not.
bool is_redundant(const kinematics::Chain& chain);

/// Whether neighbouring joints, no more than there are task axes that matter, move the transfer
/// frame in fewer directions than they are: telescopes, hinges on one line. Such chains have
/// configurations that other joints cannot stand in for, and few ways that lead there.
bool has_repeated_joints(const kinematics::Chain& chain);

}  // namespace kinship::inverse
