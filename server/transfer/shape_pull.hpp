#pragma once

#include <Eigen/Geometry>

#include "robots/inverse/descent.hpp"
#include "server/transfer/arm_pair.hpp"
#include "server/transfer/arm_shape.hpp"

namespace kinship::transfer {

/// Moves a configuration of the pair's target through its self-motion towards the posture whose
/// shape is that of the source. A step is damped least squares on the distance of the shapes, with
/// the pose as a heavily weighted part of it (Levenberg, Quarterly of Applied Mathematics 2, 1944),
/// and a descent back to the pose within the limits. A step with almost no gain ends it. ShapeLanes
/// do the same with the kernels; this is for arms with prismatic joints, along which the points of
/// a shape move.
/// \param T_base_transfer  pose of the transfer frame at `q`, which it keeps, in the target's base
///                         link.
/// \param wanted           shape of the source, in the target's base link.
/// \param steps            at most; 0: `q` stays as it is.
/// \return distance of the shapes at the end, m: never more than before.
double pull_alone(const ArmPair& pair, const Eigen::Isometry3d& T_base_transfer,
                  const ArmShape& wanted, int steps, inverse::JointVector& q);

}  // namespace kinship::transfer
