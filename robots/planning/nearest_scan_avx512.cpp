#define KINSHIP_SCAN_WIDTH 16
#include "robots/planning/nearest_scan_kernel.hpp"

namespace kinship::planning {

void scan_nearest_avx512(const ScannedNodes& nodes, long first, long end, const float* wanted,
                         ScanResult& nearest) {
  scan_nearest(nodes, first, end, wanted, nearest);
}

void box_distances_avx512(const ScannedNodes& lower, const ScannedNodes& upper, long count,
                          const float* wanted, float* squared) {
  box_distances(lower, upper, count, wanted, squared);
}

}  // namespace kinship::planning
