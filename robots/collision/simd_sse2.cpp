#define KINSHIP_SIMD_WIDTH 4
#include "robots/collision/simd_check_kernel.hpp"

namespace kinship::collision {

void check_lanes_sse2(const LaneScene& scene, LaneQuestion& question, float* places) {
  check_lanes(scene, question, places);
}

}  // namespace kinship::collision
