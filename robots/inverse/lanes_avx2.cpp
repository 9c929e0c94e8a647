#define KINSHIP_LANE_WIDTH 4
#include "robots/inverse/lane_pull_kernel.hpp"
#include "robots/inverse/lane_sets.hpp"

namespace kinship::inverse {

LaneKernels avx2_kernels() { return {step, check, pull}; }

}  // namespace kinship::inverse
