#define KINSHIP_LANE_WIDTH 8
#include "robots/inverse/lane_kernel.hpp"
#include "robots/inverse/lane_sets.hpp"

namespace kinship::inverse {

LaneKernels avx512_kernels() { return {step, check}; }

}  // namespace kinship::inverse
