#define KINSHIP_LANE_WIDTH 8
#include "robots/inverse/lane_pull_kernel.hpp"
#include "robots/inverse/lane_sets.hpp"

namespace kinship::inverse {

LaneKernels avx512_kernels() { return {step, check, pull}; }

}  // namespace kinship::inverse
