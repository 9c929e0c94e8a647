#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "robots/inverse/lanes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::inverse {

/// What `SimdKernels::eliminate` knows about an arm; nothing if it is of no use to it: not six
/// turning joints whose whole pose matters, or axes so placed that the resultant is 0 everywhere,
/// as trial shows (same chain, same answer). \param lanes  of that chain.
std::optional<LaneElimination> elimination_of(const kinematics::Chain& chain,
                                              const LaneChain& lanes, const SimdKernels& kernels);

/// Its tables, the same for every arm.
const LaneHarmonics& harmonics();

/// One pose of the transfer frame, m, as LaneBatch::target has it in one lane.
void write_target(const Eigen::Isometry3d& T_base_transfer, double length_m, double (&target)[12]);

}  // namespace kinship::inverse
