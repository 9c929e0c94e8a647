// Which configuration is nearest, KINSHIP_SCAN_WIDTH at once. Included only by the units that are
// compiled for one instruction set, which define the width: everything has internal linkage.
#ifndef KINSHIP_SCAN_WIDTH
#error "define KINSHIP_SCAN_WIDTH"
#endif

#include "robots/planning/nearest_scan.hpp"

namespace kinship::planning {
namespace {

typedef float Floats __attribute__((vector_size(4 * KINSHIP_SCAN_WIDTH)));
typedef int Ints __attribute__((vector_size(4 * KINSHIP_SCAN_WIDTH)));

inline __attribute__((always_inline)) void scan_nearest(const ScannedNodes& nodes, long first,
                                                        long end, const float* wanted,
                                                        ScanResult& nearest) {
  Floats least = Floats{} + nearest.squared;
  Ints where = Ints{} - 1;  // of each lane's least; all that was there before
  for (long i = first - first % KINSHIP_SCAN_WIDTH; i < end; i += KINSHIP_SCAN_WIDTH) {
    Floats squared = {};
    for (int joint = 0; joint < nodes.dof; ++joint) {
      Floats apart;
      __builtin_memcpy(&apart, nodes.values + joint * nodes.stride + i, sizeof apart);
      apart -= wanted[joint];
      squared += apart * apart;
    }
    const Ints nearer = squared < least;
    least = nearer ? squared : least;
    where = nearer ? Ints{} + static_cast<int>(i) : where;
  }
  int none = -1;
  for (int lane = 0; lane < KINSHIP_SCAN_WIDTH; ++lane)
    none &= where[lane];
  if (none < 0)
    return;
  for (int lane = 0; lane < KINSHIP_SCAN_WIDTH; ++lane) {
    const long index = where[lane] + lane;
    if (where[lane] >= 0 && (least[lane] < nearest.squared ||
                             (least[lane] == nearest.squared && index < nearest.index)))
      nearest = {least[lane], index};
  }
}

inline __attribute__((always_inline)) void box_distances(const ScannedNodes& lower,
                                                         const ScannedNodes& upper, long count,
                                                         const float* wanted, float* squared) {
  for (long i = 0; i < count; i += KINSHIP_SCAN_WIDTH) {
    Floats sum = {};
    for (int joint = 0; joint < lower.dof; ++joint) {
      Floats below, above;
      __builtin_memcpy(&below, lower.values + joint * lower.stride + i, sizeof below);
      __builtin_memcpy(&above, upper.values + joint * upper.stride + i, sizeof above);
      below -= wanted[joint];
      above = wanted[joint] - above;
      const Floats beyond = below > above ? below : above;
      const Floats apart = beyond > 0.0F ? beyond : Floats{};
      sum += apart * apart;
    }
    __builtin_memcpy(squared + i, &sum, sizeof sum);
  }
}

}  // namespace
}  // namespace kinship::planning
