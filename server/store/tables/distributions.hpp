#pragma once

#include <cstdint>
#include <optional>

#include "proto/types/audit.hpp"
#include "server/store/session.hpp"
#include "server/store/store.hpp"

/// Distributions, the newest revision of each. Functions that write do so in the caller's
/// transaction, under one lock for all distributions: they are not written often, and revisions and
/// what makes room for others depend on all of them.
namespace kinship::store {

/// Until the end of the transaction no other server writes distributions.
void lock_distributions(Session& session);

/// \return the revision given: 1, then one more at each call for the same id, also after an
///         eviction.
/// \throws Failure(NotFound) if its robot is not registered; Failure(InvalidInput) if it could not
///         be read back: more sources or components than the limits, a placement that is no pose.
///
/// Those not used for longest are deleted where all together would take more than `max_bytes` (0:
/// no limit), but never this one. Their revisions are not kept one by one: what is stored for the
/// first time after that, or again, begins above all of them.
std::uint64_t upsert_distribution(Session& session, const Distribution& distribution,
                                  std::uint64_t max_bytes = 0);

/// Notes that a distribution is used now, to the hour.
void note_use(Session& session, const Digest& id);

/// About what all of them take, bytes.
std::uint64_t bytes_of_distributions(Session& session);

/// A distribution without its store epoch.
struct DistributionRead {
  std::optional<Distribution> distribution;
  bool damaged = false;  ///< it is there, but cannot be used
};
DistributionRead select_distribution(Session& session, const Digest& id);

/// The one in this row.
DistributionRead read_distribution(Session& session, std::int64_t row);

/// Deletes a distribution; its revision is kept, so that the next one counts on.
/// \return whether it was there.
bool delete_distribution(Session& session, const Digest& id);

/// The same with an entry of the audit log; none if it was not there, or without `audit`.
bool evict_audited(Session& session, const Digest& id, const AuditEntry* audit);

}  // namespace kinship::store
