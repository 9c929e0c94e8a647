#pragma once

#include "server/density/simd_kernels.hpp"

namespace kinship::density {

/// Instructions that the kernels are compiled for. All give the same results except for rounding.
enum class InstructionSet { Baseline, Avx2, Avx512 };

/// The kernels of an instruction set, or null if this machine or build does not have it.
/// Baseline is always there.
const SimdKernels* find_simd_kernels(InstructionSet set);

/// The kernels with the widest vectors of this machine.
const SimdKernels& widest_simd_kernels();

}  // namespace kinship::density
