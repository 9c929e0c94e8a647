#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "robots/inverse/lanes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::inverse {

/// The data of an arm for `SimdKernels::eliminate`; nothing if that cannot solve the arm: not six
/// turning joints with all task axes, or axes whose resultant is 0 everywhere, as a trial shows
/// (same chain, same answer).
/// \param lanes  of that chain.
std::optional<LaneElimination> elimination_of(const kinematics::Chain& chain,
                                              const LaneChain& lanes, const SimdKernels& kernels);

/// Its tables, the same for every arm.
const LaneHarmonics& harmonics();

/// Writes one pose of the transfer frame, m, in the format of a lane of LaneBatch::target.
void write_target(const Eigen::Isometry3d& T_base_transfer, double length_m, double (&target)[12]);

}  // namespace kinship::inverse
