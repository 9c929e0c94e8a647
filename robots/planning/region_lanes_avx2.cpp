#include "robots/planning/region_lanes_kernel.hpp"

namespace kinship::planning {

unsigned project_lanes_avx2(const LaneRegion& region, float* qs) {
  return project_lanes(region, qs);
}

void measure_lanes_avx2(const LaneRegion& region, const float* qs, float* squared) {
  measure_lanes(region, qs, squared);
}

}  // namespace kinship::planning
