#pragma once

#include "robots/inverse/lanes.hpp"

namespace kinship::inverse {

// One unit each; to be called only where the machine knows the instructions.
LaneKernels sse2_kernels();  ///< the compiler's baseline, which on x86-64 is SSE2
LaneKernels avx2_kernels();
LaneKernels avx512_kernels();

}  // namespace kinship::inverse
