#include "server/store/postgres/opening/migrations.hpp"

#include <algorithm>
#include <string>

#include "proto/types/sha256.hpp"
#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/database/transaction.hpp"
#include "server/store/tables/audit.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/move_marks.hpp"

namespace kinship::store::postgres {
namespace {

constexpr std::int64_t kMigrationLock = 0x4B494E53;  // "KINS", of this database alone

Digest digest_of(const Migration& migration) {
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(migration.text.data());
  return Sha256().add(Bytes(bytes, migration.text.size())).finish();
}

/// The version of a store, 0 if there is none.
std::int64_t checked_version(Connection& connection, std::span<const Migration> migrations) {
  const auto newest = static_cast<std::int64_t>(migrations.size());
  if (connection.query("SELECT to_regclass('schema_migration') IS NULL").front().column_integer(0))
    return 0;
  std::int64_t version = 0;
  for (const Row row :
       connection.query("SELECT version, sha256 FROM schema_migration ORDER BY version")) {
    if (row.column_integer(0) != ++version)
      throw Failure(ErrorCode::Storage,
                    "its migrations have a gap before " + std::to_string(row.column_integer(0)));
    if (version > newest)
      continue;
    const Digest known = digest_of(migrations[static_cast<std::size_t>(version - 1)]);
    if (!std::ranges::equal(row.column_blob(1), known.bytes))
      throw Failure(ErrorCode::Storage, "it was made by " + another_migration(version));
  }
  if (version > newest)
    throw Failure(ErrorCode::Storage, "it has schema " + newer_schema(version, newest));
  return version;
}

void apply(Connection& connection, const Migration& migration) {
  connection.execute(std::string(migration.text));
  const Digest digest = digest_of(migration);
  connection.query("INSERT INTO schema_migration VALUES ($1, $2, $3, $4, $5)", migration.version,
                   migration.name, Bytes(digest.bytes), now_ms(),
                   connection.parameter("server_version"));
}

}  // namespace

void migrate(Connection& connection, std::span<const Migration> migrations) {
  const auto newest = static_cast<std::int64_t>(migrations.size());
  if (checked_version(connection, migrations) == newest)
    return;
  Transaction transaction(connection, Transaction::Kind::Local);
  // Of the transaction, not of the session: a pooler may give each transaction another session.
  connection.query("SELECT pg_advisory_xact_lock($1) IS NULL", kMigrationLock);
  const std::int64_t version = checked_version(connection, migrations);
  if (version > 0)  // writers of the old schema end first, and see the new one when they begin
    connection.execute("LOCK TABLE schema_migration IN ACCESS EXCLUSIVE MODE");
  for (const Migration& migration : migrations.subspan(static_cast<std::size_t>(version)))
    apply(connection, migration);
  if (version > 0)
    insert_audit(connection, entry_of_migration(connection.description(), version, newest));
  if (const CommitOutcome outcome = transaction.commit(); outcome.certainty != Certainty::Committed)
    throw Failure(ErrorCode::Storage, "its schema could not be made: " + outcome.why);
}

std::int64_t schema_of(Connection& connection) {
  return connection.query("SELECT coalesce(max(version), 0) FROM schema_migration")
      .front()
      .column_integer(0);
}

void require_schema(std::int64_t version) {
  if (const std::int64_t newest = std::ssize(embedded_migrations()); version != newest)
    throw PostgresError("55000", "the database has schema " + newer_schema(version, newest));
}

}  // namespace kinship::store::postgres
