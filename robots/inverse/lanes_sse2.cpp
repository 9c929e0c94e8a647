#define KINSHIP_LANE_WIDTH 2
#include "robots/inverse/lane_pull_kernel.hpp"
#include "robots/inverse/lane_sets.hpp"

namespace kinship::inverse {

LaneKernels sse2_kernels() { return {step, check, pull}; }

}  // namespace kinship::inverse
