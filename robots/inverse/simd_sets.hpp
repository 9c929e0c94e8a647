#pragma once

#include "robots/inverse/lanes.hpp"

namespace kinship::inverse {

// One unit each; to be called only where the machine knows the instructions.
SimdKernels sse2_simd_kernels();  ///< the compiler's baseline, which on x86-64 is SSE2
SimdKernels avx2_simd_kernels();
SimdKernels avx512_simd_kernels();

}  // namespace kinship::inverse
