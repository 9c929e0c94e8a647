#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "server/store/postgres/database/connection.hpp"

namespace kinship::store::postgres {

/// One file of schema/postgresql.
struct Migration {
  std::int64_t version = 0;  ///< 1, 2, 3, ... without gaps
  std::string_view name;     ///< of the file, without ".sql"
  std::string_view text;
};

/// All migrations that this binary knows, by version (written by cmake/embed_texts.cmake).
std::span<const Migration> embedded_migrations();

/// Applies the missing ones of `migrations` to a database, all in one transaction, while no other
/// server does; the migration of an existing store gets an entry in the audit log. Writes nothing
/// if none is missing.
/// \throws Failure(Storage) if the database is newer than `migrations`, or was made by a migration
///         of another text, or has other tables with the names of a store's.
void migrate(Connection& connection, std::span<const Migration> migrations);

/// Of a store that another server may have migrated meanwhile.
std::int64_t schema_of(Connection& connection);
/// \throws PostgresError unless `version` is the newest that this binary knows.
void require_schema(std::int64_t version);

}  // namespace kinship::store::postgres
