#pragma once

#include <cstdint>
#include <vector>

namespace kinship::density {

/// From so many paths on a part of them is held out to score numbers of components.
inline constexpr std::uint32_t kMinPathsToScore = 10;

/// A path is in one of so many parts, each of which may be held out.
inline constexpr std::uint32_t kFolds = 5;

/// Which paths of `count` are held out: a fifth of them, chosen by the seed; none below
/// kMinPathsToScore. Whole paths, because waypoints of one path are not independent.
/// \param fold  which fifth, below kFolds.
/// \return count flags.
std::vector<std::uint8_t> held_out_paths(std::uint32_t count, std::uint64_t seed,
                                         std::uint32_t fold = 0);

/// What a number is chosen by: per fold, which paths are held out. The first fold alone with many
/// paths, each up to kFewPaths, and below kMinPathsToScore each path in turn; none of one path.
std::vector<std::vector<std::uint8_t>> folds_of(std::uint32_t paths, std::uint64_t seed);

/// One fold of so many paths is too few to choose by.
inline constexpr std::uint32_t kFewPaths = 60;

}  // namespace kinship::density
