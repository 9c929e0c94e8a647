#pragma once

#include "server/density/block_kernels.hpp"

namespace kinship::density {

/// Instructions that the kernels are compiled for. All give the same results but for rounding.
enum class InstructionSet { Baseline, Avx2, Avx512 };

/// The kernels of an instruction set, or null if this machine or build does not have it.
/// Baseline is always there.
const BlockKernels* find_kernels(InstructionSet set);

/// Those of the widest vectors that this machine has.
const BlockKernels& widest_kernels();

}  // namespace kinship::density
