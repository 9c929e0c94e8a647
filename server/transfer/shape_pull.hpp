#pragma once

#include <Eigen/Geometry>

#include "robots/inverse/descent.hpp"
#include "server/transfer/arm_pair.hpp"
#include "server/transfer/arm_shape.hpp"

namespace kinship::transfer {

/// Moves a configuration of the pair's target through its self-motion towards the posture whose arm
/// lies as the source's did. A step is damped least squares on the distance of the shapes, with the
/// pose as a heavily weighted part of it (Levenberg, Quarterly of Applied Mathematics 2, 1944), and
/// a descent back to the pose within the limits. A step that brings next to nothing ends it.
/// ShapeLanes do the same with the kernels; this is for arms with sliding joints, along which the
/// points of a shape wander.
/// \param T_base_transfer  where the transfer frame is at `q` and stays, in the target's base link.
/// \param wanted           shape of the source, in the target's base link.
/// \param steps            at most; 0: `q` stays as it is.
/// \return how far the shapes are apart at the end, m: never more than before.
double pull_alone(const ArmPair& pair, const Eigen::Isometry3d& T_base_transfer,
                  const ArmShape& wanted, int steps, inverse::JointVector& q);

}  // namespace kinship::transfer
