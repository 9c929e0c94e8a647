#define KINSHIP_SIMD_WIDTH 2
#include "robots/inverse/lanes.hpp"
#include "robots/inverse/simd_elimination_kernel.hpp"
#include "robots/inverse/simd_pull_kernel.hpp"
#include "robots/inverse/simd_wrist_kernel.hpp"

namespace kinship::inverse {

SimdKernels sse2_simd_kernels() { return {step, check, pull, eliminate, wrist}; }

}  // namespace kinship::inverse
