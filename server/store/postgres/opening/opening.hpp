#pragma once

#include <memory>

#include "proto/types/uuid.hpp"
#include "server/store/postgres/database/connection.hpp"
#include "server/store/postgres/opening/history.hpp"
#include "server/store/postgres/opening/primary.hpp"

namespace kinship::store::postgres {

/// That a server can keep a store: PostgreSQL 13 or newer, UTF-8, and not read-only as a standby
/// is. \throws PostgresError that says in words what is wrong.
void require_usable(Connection& connection);

/// A connection that may write to a store of the schema of today, which is made or migrated.
/// \throws Failure(Storage).
std::unique_ptr<Connection> open_store_connection(const ConnectionString& where,
                                                  const ConnectionOptions& options);

/// The first connection of a store, which has today's schema then, and a run on it. Behind a pooler
/// a session may have statements of others by the names of ours: that is known from the first one
/// on, and none are kept then.
///
/// The server is noted among those that are alive before it looks whether the store is being moved:
/// who moves it first says so, then looks who is alive, so one of the two sees the other.
/// \throws PostgresError; Failure; Failure(Unavailable) if it is half moved, or was moved
/// elsewhere.
std::unique_ptr<Connection> begin_store(Primary& primary, History& history, const Uuid& server);

}  // namespace kinship::store::postgres
