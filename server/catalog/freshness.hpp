#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::catalog {

/// Minimum time between fits of a distribution, unless a client waits for a generation.
inline constexpr std::chrono::milliseconds kRefitInterval{10'000};

// `experience` is that of the distribution's selection (selected_experience) unless said otherwise.

/// Whether the paths grew by max(5, 5 %) since the distribution was fitted. The 5 % are of the
/// paths that it could use: with a date, of the paths since. At a source's cap, paths that replaced
/// others count as growth.
bool has_grown(const Distribution& distribution,
               const std::vector<store::ExperienceSummary>& experience);

/// Whether the experience of any source differs from that at the fit.
bool has_changed(const Distribution& distribution,
                 const std::vector<store::ExperienceSummary>& experience);

/// Whether a new fit could improve on this distribution: a mixture becomes outdated by growth, a
/// failure by any change.
bool is_behind(const Distribution& distribution,
               const std::vector<store::ExperienceSummary>& experience);

/// Whether paths that it may have been made of were retired since: such a distribution is neither
/// served nor kept.
/// \param experience  all of the task's. A missing source counts as retired, and so does one with a
///                    smaller generation: it is of another task, to which the name was given.
bool is_retired(const Distribution& distribution,
                const std::vector<store::ExperienceSummary>& experience);

/// Whether kRefitInterval has passed since the fit; a clock that was set back counts as passed.
bool may_refit(const Distribution& distribution, std::int64_t now_ms);

/// Time until may_refit(); 0: now.
std::chrono::milliseconds until_refit(std::int64_t fitted_ms, std::int64_t now_ms);

/// Generation of a robot's own experience: in the store now, and when a distribution was fitted.
/// 0: it had none.
std::uint64_t generation_of(const Digest& robot,
                            const std::vector<store::ExperienceSummary>& experience);
std::uint64_t own_generation(const Distribution& distribution);

}  // namespace kinship::catalog
