#pragma once

#include <cstdint>
#include <vector>

#include "proto/types/profile.hpp"
#include "server/transfer/arm_pair.hpp"
#include "server/transfer/filters.hpp"
#include "server/transfer/path_poses.hpp"
#include "server/transfer/random_solutions.hpp"

namespace kinship::transfer {

/// Random solutions of the poses of a path that no track covers.
///
/// A pose without a solution costs far more than one with some, and such poses stand side by side.
/// Patience is therefore kept for those at which the outcome is open: a pose that had nothing to
/// give without patience gets it if a pose beside it is reached, by a track or a solution (that
/// filters may have left out), or if it ends the path. So every row of poses without a solution
/// ends in two that were looked at with patience, and what each of the others has depends on the
/// seed and that pose only.
///
/// \param covered  one per pose.
/// \return         one per pose; without configurations and reason where `covered`.
std::vector<RandomSolutions> solve_uncovered(const ArmPair& pair, const PathPoses& poses,
                                             const std::vector<bool>& covered,
                                             const TransferParameters& parameters,
                                             std::uint64_t seed, CountedFilters& filters);

}  // namespace kinship::transfer
