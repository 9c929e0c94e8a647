#pragma once

#include <cstdint>
#include <vector>

#include "server/store/session.hpp"
#include "server/store/store.hpp"

/// Rehearsals, the newest of each distribution; see RehearsalStore.
namespace kinship::store {

/// Adds a row beside earlier ones of its distribution.
/// \throws Failure(InvalidInput) if it could not be read back.
void insert_rehearsal(Session& session, const StoredRehearsal& rehearsal);

/// Rows to be dropped: earlier ones of a distribution, and the oldest beyond the limits, but never
/// the newest.
std::vector<std::int64_t> find_surplus_rehearsals(Session& session, const RehearsalLimits& limits);

std::vector<StoredRehearsal> select_rehearsals(Session& session, std::size_t limit);

/// Deletes all rehearsals of a task.
void delete_rehearsals_of(Session& session, std::string_view task);

/// Whether a row is there as it was written, maybe by another version.
bool is_rehearsal_sound(Session& session, std::int64_t row);

/// Deletes a row; a damaged one may stay. A page that SQLite cannot read fails the transaction.
void drop_rehearsal(Session& session, std::int64_t row);

}  // namespace kinship::store
