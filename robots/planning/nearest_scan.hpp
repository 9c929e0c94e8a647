#pragma once

// Included by the units that are compiled for one instruction set: nothing here may bring inline
// functions or templates of other libraries along that these units would use.
namespace kinship::planning {

inline constexpr long kScanBlock = 16;  ///< configurations scanned side by side

/// Configurations side by side, as plain numbers: joint after joint, `stride` apart. Behind the
/// last one infinity, up to a multiple of kScanBlock.
struct ScannedNodes {
  const float* values;  ///< of any alignment
  long stride;          ///< a multiple of kScanBlock
  int dof;
};

/// The nearest so far.
struct ScanResult {
  float squared;
  long index;
};

/// Searches for a nearer one among some of the configurations, the first of equals; it may scan
/// some before `first` again. Sums in the order of the joints, rounded after each operation: the
/// answer does not depend on the instruction set.
using NearestScan = void (*)(const ScannedNodes& nodes, long first, long end, const float* wanted,
                             ScanResult& nearest);

/// Squared distances of a configuration to boxes, given as their lower and upper corners; never
/// more than that of a configuration in the box. \param squared  room for all, in whole
/// kScanBlocks.
using BoxDistances = void (*)(const ScannedNodes& lower, const ScannedNodes& upper, long count,
                              const float* wanted, float* squared);

// One unit each; to be called only where the machine knows the instructions.
void scan_nearest_sse2(const ScannedNodes&, long, long, const float*, ScanResult&);  ///< baseline
void scan_nearest_avx2(const ScannedNodes&, long, long, const float*, ScanResult&);
void scan_nearest_avx512(const ScannedNodes&, long, long, const float*, ScanResult&);
void box_distances_sse2(const ScannedNodes&, const ScannedNodes&, long, const float*, float*);
void box_distances_avx2(const ScannedNodes&, const ScannedNodes&, long, const float*, float*);
void box_distances_avx512(const ScannedNodes&, const ScannedNodes&, long, const float*, float*);

struct Scans {
  NearestScan nodes;
  BoxDistances boxes;
};

/// The scans for this machine's instruction set.
const Scans& fastest_scans();

}  // namespace kinship::planning
