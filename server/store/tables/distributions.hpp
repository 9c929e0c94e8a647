#pragma once

#include <cstdint>
#include <optional>

#include "proto/types/audit.hpp"
#include "server/store/session.hpp"
#include "server/store/store.hpp"

/// Distributions, the newest revision of each. Functions that write use the caller's transaction,
/// under one lock for all distributions: writes are rare, and revisions and evictions for room
/// depend on all of them.
namespace kinship::store {

/// Keeps other servers from writing distributions until the end of the transaction.
void lock_distributions(Session& session);

/// Stores a distribution; beyond `max_bytes` of all distributions (0: no limit) deletes the least
/// recently used ones, but never this one. The revisions of deleted ones are not kept one by one: a
/// distribution stored afterwards begins above all of them.
/// \return the revision: 1, then one more at each call for the same id, also after an eviction.
/// \throws Failure(NotFound) if its robot is not registered; Failure(InvalidInput) if it could not
///         be read back: more sources or components than the limits, a placement that is no pose.
std::uint64_t upsert_distribution(Session& session, const Distribution& distribution,
                                  std::uint64_t max_bytes = 0);

/// Notes the current use of a distribution, to the hour.
void note_use(Session& session, const Digest& id);

/// Size of all distributions, bytes, about.
std::uint64_t bytes_of_distributions(Session& session);

/// A distribution without its store epoch.
struct DistributionRead {
  std::optional<Distribution> distribution;
  bool damaged = false;  ///< the row exists but cannot be used
};
DistributionRead select_distribution(Session& session, const Digest& id);

/// Reads the distribution in a row.
DistributionRead read_distribution(Session& session, std::int64_t row);

/// Deletes a distribution; its revision is kept, so that the next one counts on.
/// \return whether it existed.
bool delete_distribution(Session& session, const Digest& id);

/// The same with an entry in the audit log; no entry if it did not exist, or without `audit`.
bool evict_audited(Session& session, const Digest& id, const AuditEntry* audit);

}  // namespace kinship::store
