#pragma once

#include <span>
#include <stop_token>

#include "proto/types/summaries.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// Undoes retirements: stores each retired path anew, as a report of its own, so that other stores
/// take it over as any new report, where the retirement of the first one stands. The UUID follows
/// from that of the retired report, so that a repetition changes nothing. The copy counts as
/// planned uniformly: an attempt is evidence once. Waits for the store.
///
/// \param reports   each once; every kMaxAttemptsPerBatch of them are stored at once.
/// \param stop      ends it between two of these.
/// \param restored  in: so far; out: with these, of which each is restored or left out.
/// \throws Failure(Unavailable) if the store takes none now, or it is stopped; those before are
///         restored. One that the store does not take by itself, while it takes others, is left
///         out.
void restore_paths(store::Store& store, std::span<const Uuid> reports, const std::stop_token& stop,
                   Restoration& restored);

/// UUID of the report that restores the path of a retired one.
Uuid restored_report(const Uuid& retired);

}  // namespace kinship::service
