#pragma once

#include <cstdint>
#include <vector>

#include "proto/types/selection.hpp"
#include "server/fitting/distribution_key.hpp"
#include "server/store/store.hpp"

namespace kinship::fitting {

/// Whether a distribution of this key is made of this robot's experience.
bool selects(const DistributionKey& key, const Digest& robot);

/// The part of a task's experience that a distribution of this key is made of. Robots that have no
/// path left are not part of it, but for the target itself.
std::vector<store::ExperienceSummary> selected_experience(
    const DistributionKey& key, const std::vector<store::ExperienceSummary>& experience);

std::uint64_t count_paths(const std::vector<store::ExperienceSummary>& experience);

/// How many paths of each source a fit reads if it may read `most` of all together.
/// Weighting::Sources: as many of each, where a source that has fewer leaves its places to the
/// others. Weighting::Paths: in proportion to what they have. At least one of each that has any.
std::vector<std::uint64_t> share_paths(const std::vector<std::uint64_t>& paths_of_source,
                                       std::uint64_t most, Weighting weighting);

}  // namespace kinship::fitting
