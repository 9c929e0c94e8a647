#define KINSHIP_SIMD_WIDTH 8
#include "robots/collision/simd_check_kernel.hpp"

namespace kinship::collision {

void check_lanes_avx512vl(const LaneScene& scene, LaneQuestion& question, float* places) {
  check_lanes(scene, question, places);
}

}  // namespace kinship::collision
