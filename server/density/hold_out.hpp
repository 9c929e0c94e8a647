#pragma once

#include <cstdint>
#include <vector>

namespace kinship::density {

/// Least number of paths of which a part is held out to score numbers of components.
inline constexpr std::uint32_t kMinPathsToScore = 10;

/// Number of parts of the paths, each of which may be held out.
inline constexpr std::uint32_t kFolds = 5;

/// Which paths of `count` are held out: a fifth of them, chosen by the seed; none below
/// kMinPathsToScore. Whole paths, because waypoints of one path are not independent.
/// \param fold  which fifth, below kFolds.
/// \return count flags.
std::vector<std::uint8_t> held_out_paths(std::uint32_t count, std::uint64_t seed,
                                         std::uint32_t fold = 0);

/// The folds by which a parameter is chosen: for each, which paths are held out. With many paths
/// the first fold alone, up to kFewPaths all folds, below kMinPathsToScore each path in turn; none
/// for one path.
std::vector<std::vector<std::uint8_t>> folds_of(std::uint32_t paths, std::uint64_t seed);

/// Up to this many paths, one fold is too few to choose by.
inline constexpr std::uint32_t kFewPaths = 60;

}  // namespace kinship::density
