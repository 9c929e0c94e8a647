#pragma once

#include <cstdint>
#include <vector>

#include "proto/types/selection.hpp"
#include "server/fitting/distribution_key.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::fitting {

/// Whether a distribution of this key uses this robot's experience.
bool selects(const DistributionKey& key, const Digest& robot);

/// The part of a task's experience that a distribution of this key uses. Robots without paths are
/// left out, except the target itself.
std::vector<store::ExperienceSummary> selected_experience(
    const DistributionKey& key, const std::vector<store::ExperienceSummary>& experience);

std::uint64_t count_paths(const std::vector<store::ExperienceSummary>& experience);

/// Number of paths of each source that a fit reads if it may read `most` together.
/// Weighting::Sources: equally many of each, where a source with fewer leaves its places to the
/// others. Weighting::Paths: in proportion to their numbers. At least one of each source that has
/// any.
std::vector<std::uint64_t> share_paths(const std::vector<std::uint64_t>& paths_of_source,
                                       std::uint64_t most, Weighting weighting);

}  // namespace kinship::fitting
