#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "server/store/store.hpp"

namespace kinship::catalog {

/// A distribution is fitted again at most this often, unless somebody waits for a generation.
inline constexpr std::chrono::milliseconds kRefitInterval{10'000};

// `experience` is that of the distribution's selection (selected_experience) unless it says other.

/// Whether the paths grew by max(5, 5 %) since the distribution was fitted. The 5 % are of the
/// paths that it could use: of those since its date, if it has one. Where a source has as many
/// paths as it may, those that took the place of others count as growth.
bool has_grown(const Distribution& distribution,
               const std::vector<store::ExperienceSummary>& experience);

/// Whether any source's experience is another than the one the distribution was made of.
bool has_changed(const Distribution& distribution,
                 const std::vector<store::ExperienceSummary>& experience);

/// Whether a fit could say more than this distribution: a mixture grows old by growth, a failure
/// by any change.
bool is_behind(const Distribution& distribution,
               const std::vector<store::ExperienceSummary>& experience);

/// Whether paths it may have been made of were taken out of every fit since: such a distribution
/// is neither served nor kept.
/// \param experience  all of the task's. A source that is not there any more counts as retired.
bool is_retired(const Distribution& distribution,
                const std::vector<store::ExperienceSummary>& experience);

/// Whether kRefitInterval has passed since the fit; a clock that was set back counts as passed.
bool may_refit(const Distribution& distribution, std::int64_t now_ms);

/// How long that takes from now; 0: it may.
std::chrono::milliseconds until_refit(std::int64_t fitted_ms, std::int64_t now_ms);

/// Generation of a robot's own experience: in the store now, and when a distribution was fitted.
/// 0: it had none.
std::uint64_t generation_of(const Digest& robot,
                            const std::vector<store::ExperienceSummary>& experience);
std::uint64_t own_generation(const Distribution& distribution);

}  // namespace kinship::catalog
