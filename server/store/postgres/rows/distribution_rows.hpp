#pragma once

#include <cstdint>
#include <optional>

#include "proto/types/audit.hpp"
#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"

/// Distributions, the newest revision of each. Who writes them takes one lock for all: that is not
/// often, and revisions and what makes room for others depend on all of them.
namespace kinship::store::postgres {

/// Until the end of the transaction nobody else writes distributions; what a robot has stays so.
void lock_distributions(Connection& connection);

/// In a transaction of the caller's.
/// \return the revision given: 1, then one more at each call for the same id, also after an
/// eviction. \throws Failure(NotFound) if its robot is not registered; Failure(InvalidInput) if it
/// could not
///         be read back: more sources or components than the limits, a placement that is no pose.
///
/// Those not used for longest are deleted where all together would take more than `max_bytes` (0:
/// no limit), but never this one. Their revisions are not kept one by one: what is stored for the
/// first time after that, or again, begins above all of them.
std::uint64_t upsert_distribution(Connection& connection, const Distribution& distribution,
                                  std::uint64_t max_bytes = 0);

/// Notes that a distribution is used now, to the hour.
void note_use(Connection& connection, const Digest& id);

/// About what all of them take, bytes.
std::uint64_t bytes_of_distributions(Connection& connection);

/// A distribution without its store epoch.
struct DistributionRead {
  std::optional<Distribution> distribution;
  bool damaged = false;  ///< it is there, but cannot be used
};
DistributionRead select_distribution(Connection& connection, const Digest& id);

/// Deletes a distribution; its revision is kept, so that the next one counts on. In a transaction
/// of the caller's. \return whether it was there.
bool delete_distribution(Connection& connection, const Digest& id);

/// The same with an entry of the audit log; none if it was not there, or without `audit`.
bool evict_audited(Connection& connection, const Digest& id, const AuditEntry* audit);

}  // namespace kinship::store::postgres
