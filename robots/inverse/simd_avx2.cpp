#define KINSHIP_SIMD_WIDTH 4
#include "robots/inverse/lanes.hpp"
#include "robots/inverse/simd_elimination_kernel.hpp"
#include "robots/inverse/simd_pull_kernel.hpp"
#include "robots/inverse/simd_wrist_kernel.hpp"

namespace kinship::inverse {

SimdKernels avx2_simd_kernels() { return {step, check, pull, eliminate, wrist}; }

}  // namespace kinship::inverse
