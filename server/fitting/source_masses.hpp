#pragma once

#include <cstdint>
#include <vector>

namespace kinship::fitting {

/// A source robot in a pool of configurations.
struct PooledSource {
  std::uint64_t paths = 0;  ///< with at least one configuration
  bool own = false;         ///< the target robot itself
};

/// Up to this many paths, the part of a source grows with their number; more do not add to it.
inline constexpr std::uint64_t kFullPartPaths = 5;
/// From this many own paths on, the target's own experience is at least half of all.
inline constexpr std::uint64_t kOwnHalfPaths = 30;

/// Mass of each source if sources count the same, however many paths they have; sum 1, or all 0
/// without paths. A source of n paths gets min(n, 5) / 5 of a part. The own experience gets at
/// least 1/2 (n - 5) / 25 of all, at most 1/2: nothing more than its part at 5 paths, half of all
/// from 30 on, even steps between.
std::vector<double> source_masses(const std::vector<PooledSource>& sources);

}  // namespace kinship::fitting
