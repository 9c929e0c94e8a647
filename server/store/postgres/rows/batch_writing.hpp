#pragma once

#include "server/store/postgres/database/connection.hpp"
#include "server/store/rules/batch_changes.hpp"

namespace kinship::store::postgres {

/// Writes changes in one round trip, in the transaction under whose locks they were resolved.
/// \throws PostgresError of kind Conflict if another server wrote one of its reports meanwhile, for
///         another robot or task: then the transaction is to be tried again.
void write_changes(Connection& connection, const BatchChanges& changes, std::int64_t now_ms);

}  // namespace kinship::store::postgres
