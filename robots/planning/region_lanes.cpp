#include "robots/planning/region_lanes.hpp"

namespace kinship::planning {
namespace {

RegionKernels find_region_kernels() {
#ifdef KINSHIP_SIMD_X86
  if (__builtin_cpu_supports("avx2"))
    return {project_lanes_avx2, measure_lanes_avx2};
#endif
  return {project_lanes_sse2, measure_lanes_sse2};
}

}  // namespace

const RegionKernels& fastest_region_kernels() {
  static const RegionKernels kFastest = find_region_kernels();
  return kFastest;
}

}  // namespace kinship::planning
