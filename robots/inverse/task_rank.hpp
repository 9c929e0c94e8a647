#pragma once

#include "robots/kinematics/chain.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::inverse {

/// Jacobian of the transfer frame in the base link, m and rad per joint unit; rows of task axes
/// that do not matter are 0.
kinematics::Jacobian task_jacobian(const kinematics::Chain& chain,
                                   const Eigen::Ref<const Eigen::VectorXd>& q);

/// Number of independent directions of the task axes that matter in which the joints move the
/// transfer frame, at the best of a few random configurations within limits. Directions too weak
/// for a step of the descent, or due to rounding in a model file, do not count.
Eigen::Index task_rank(const kinematics::Chain& chain);

/// Whether some motion of the joints keeps the pose: there are more joints than directions in which
/// they move the transfer frame. Six joints of which two telescopes slide side by side are
/// redundant, five turning ones in general are not.
bool is_redundant(const kinematics::Chain& chain);

/// Whether some neighbouring joints, at most as many as the task axes that matter, move the
/// transfer frame in fewer directions than their number: telescopes, hinges on one line. Such
/// chains have configurations that other joints cannot replace, and few ways lead there.
bool has_repeated_joints(const kinematics::Chain& chain);

}  // namespace kinship::inverse
