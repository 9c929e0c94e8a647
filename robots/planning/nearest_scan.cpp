#include "robots/planning/nearest_scan.hpp"

namespace kinship::planning {
namespace {

Scans find_fastest() {
#ifdef KINSHIP_SIMD_X86
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return {scan_nearest_avx512, box_distances_avx512};
  if (__builtin_cpu_supports("avx2"))
    return {scan_nearest_avx2, box_distances_avx2};
#endif
  return {scan_nearest_sse2, box_distances_sse2};
}

}  // namespace

const Scans& fastest_scans() {
  static const Scans kFastest = find_fastest();
  return kFastest;
}

}  // namespace kinship::planning
