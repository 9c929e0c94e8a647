#pragma once

#include "server/store/postgres/database/connection.hpp"

namespace kinship::store::postgres {

/// That a server can keep a store: PostgreSQL 13 or newer, UTF-8, and not read-only as a standby
/// is. \throws PostgresError that says in words what is wrong.
void require_usable(Connection& connection);

/// A connection that may write to a store of the schema of today, which is made or migrated.
/// \throws Failure(Storage).
std::unique_ptr<Connection> open_store_connection(const ConnectionString& where,
                                                  const ConnectionOptions& options);

}  // namespace kinship::store::postgres
