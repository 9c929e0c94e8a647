#pragma once

#include <span>
#include <string_view>

#include "robots/inverse/lanes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::inverse {

/// The kernels of one instruction set and its name.
struct InstructionSet {
  std::string_view name;  ///< "sse2", "avx2", "avx512"
  SimdKernels kernels;
};

/// The instruction sets of this machine, the slowest first; at least one.
std::span<const InstructionSet> instruction_sets();

/// The chain for `SimdKernels::step`. Its unit of length is a power of two near the arm's reach, so
/// that robots of any size descend alike.
LaneChain lane_chain(const kinematics::Chain& chain);

/// The chain for `SimdKernels::check`.
LaneArm lane_arm(const kinematics::Chain& chain);

/// Sum of the lengths between joints: no configuration puts the transfer frame farther than this
/// from the first joint's origin, m.
double reach_m(const kinematics::Chain& chain);

}  // namespace kinship::inverse
