#pragma once

#include <memory>

#include "proto/types/uuid.hpp"
#include "server/store/postgres/database/connection.hpp"
#include "server/store/postgres/opening/history.hpp"
#include "server/store/postgres/opening/primary.hpp"

namespace kinship::store::postgres {

/// Checks that a database server can hold a store: PostgreSQL 13 or newer, UTF-8, and not read-only
/// as a standby is.
/// \throws PostgresError with the reason.
void require_usable(Connection& connection);

/// A connection that may write to a store with the newest schema; makes or migrates the store.
/// \throws Failure(Storage).
std::unique_ptr<Connection> open_store_connection(const ConnectionString& where,
                                                  const ConnectionOptions& options);

/// The first connection of a store, with a run on it; makes or migrates the store. Behind a
/// connection pooler a session may have prepared statements of other clients with the names of
/// ours: the first statement shows that, and then no statement is kept prepared.
///
/// The server registers as alive before it checks whether the store is being moved; a move sets its
/// mark before it checks for live servers. So one of the two sees the other.
/// \throws PostgresError; Failure; Failure(Unavailable) if the store is filled by a move, or was
///         moved elsewhere.
std::unique_ptr<Connection> begin_store(Primary& primary, History& history, const Uuid& server);

}  // namespace kinship::store::postgres
