#include "server/store/sqlite/opening/migrations.hpp"

#include <sqlite3.h>

#include <functional>
#include <map>
#include <string>

#include "proto/types/sha256.hpp"
#include "server/store/sqlite/database/online_backup.hpp"
#include "server/store/sqlite/database/row_checksums.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/files/store_file.hpp"
#include "server/store/tables/audit.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/move_marks.hpp"

namespace kinship::store {
namespace {

constexpr std::int64_t kApplicationId = 0x4B494E53;  // "KINS"; set by migration 1

Digest text_digest(const Migration& migration) {
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(migration.text.data());
  return Sha256().add(Bytes(bytes, migration.text.size())).finish();
}

/// 0: an empty file. Otherwise the version of a Kinship store.
std::int64_t checked_version(Database& database, const std::filesystem::path& file,
                             std::span<const Migration> migrations) {
  std::int64_t application = 0;
  try {
    application = database.integer("PRAGMA application_id");
  } catch (const SqliteError& error) {
    if ((error.sqlite_code() & 0xFF) == SQLITE_NOTADB)
      refuse_store(file, "is no SQLite database");
    throw;
  }
  if (application == 0 && database.integer("SELECT count(*) FROM sqlite_master") == 0)
    return 0;
  if (application != kApplicationId)
    refuse_store(file, "is a database, but no Kinship store");
  const std::int64_t version = database.integer("PRAGMA user_version");
  const auto newest = static_cast<std::int64_t>(migrations.size());
  if (version > newest)
    refuse_store(file, "has schema " + newer_schema(version, newest));
  return version;
}

void check_history(Database& database, const std::filesystem::path& file, std::int64_t version,
                   std::span<const Migration> migrations) {
  Statement applied(database.connection(),
                    "SELECT version, sha256 FROM schema_migration ORDER BY version");
  std::int64_t expected = 0;
  while (applied.step()) {
    ++expected;
    if (applied.column_integer(0) != expected || expected > version)
      break;
    const Digest known = text_digest(migrations[static_cast<std::size_t>(expected - 1)]);
    const Bytes stored = applied.column_blob(1);
    if (!std::equal(stored.begin(), stored.end(), known.bytes.begin(), known.bytes.end()))
      refuse_store(file, "was made by " + another_migration(expected));
  }
  if (expected != version)
    refuse_store(file, "says schema " + std::to_string(version) +
                           ", but records migrations up to " + std::to_string(expected));
}

/// Rows of tables that got columns are intact with them, if they were intact before. A migration
/// that takes away a column of a checked table fails here.
void renew_checksums(Database& database,
                     const std::map<std::string, CheckedTable, std::less<>>& before) {
  for (const auto& [name, table] : read_checked_tables(database.connection()))
    if (const auto old = before.find(name);
        old != before.end() && old->second.columns != table.columns)
      database.execute("UPDATE " + name + " SET row_crc32c = " + table.checksum("") +
                       " WHERE row_crc32c = " + old->second.checksum(""));
}

/// Without foreign keys while it lasts, which a table that is written anew would trip over: each
/// migration leaves them as they were, which `kinshipd check` compares.
/// \param is_noted  in the audit log.
void apply(Database& database, const std::filesystem::path& file, const Migration& migration,
           bool is_noted) {
  database.execute("PRAGMA foreign_keys = OFF");
  Transaction transaction(database, Transaction::Kind::Write);
  const auto tables = read_checked_tables(database.connection());
  database.execute(std::string(migration.text));
  renew_checksums(database, tables);
  const Digest digest = text_digest(migration);
  Statement(database.connection(), "INSERT INTO schema_migration VALUES (?, ?, ?, ?, ?)")
      .bind_all(migration.version, migration.name, Bytes(digest.bytes), now_ms(),
                std::string_view(sqlite3_libversion()))
      .run();
  database.execute("PRAGMA user_version = " + std::to_string(migration.version));
  database.keep_checksums();
  if (is_noted)
    insert_audit(database,
                 entry_of_migration(file.string(), migration.version - 1, migration.version));
  transaction.commit();
  database.execute("PRAGMA foreign_keys = ON");
}

/// Copies a database to backup_of_version().
void keep_copy_of(Database& database, const std::filesystem::path& file, std::int64_t version) {
  files::NewFileOptions options = kNewDatabase;
  options.may_replace = true;
  files::NewFile backup(backup_of_version(file, version), options);
  copy_database(database, backup.part(), [](double) {});
  backup.publish();
}

/// The SQL of all objects of a schema, by name.
std::map<std::string, std::string> schema_of(Database& database) {
  std::map<std::string, std::string> schema;
  Statement objects(database.connection(), "SELECT name, sql FROM main.sqlite_master");
  while (objects.step())
    schema.emplace(objects.column_text(0), objects.column_text(1));
  return schema;
}

/// A flipped bit may leave SQL that SQLite can read. Objects that others added count for nothing.
void require_whole_schema(Database& database, std::span<const Migration> migrations) {
  Database fresh(":memory:", Access::ReadWrite);
  for (const Migration& migration : migrations)
    fresh.execute(std::string(migration.text));
  const std::map<std::string, std::string> found = schema_of(database);
  for (const auto& [name, sql] : schema_of(fresh))
    if (const auto object = found.find(name); object == found.end() || object->second != sql)
      throw SqliteError(SQLITE_CORRUPT, "the schema is damaged at '" + name + "'");
}

}  // namespace

std::int64_t known_schema(Database& database, const std::filesystem::path& file,
                          std::span<const Migration> migrations) {
  const std::int64_t version = checked_version(database, file, migrations);
  if (version > 0)
    check_history(database, file, version, migrations);
  if (version > 0 && version == std::ssize(migrations))
    require_whole_schema(database, migrations);
  return version;
}

std::filesystem::path backup_of_version(const std::filesystem::path& file, std::int64_t version) {
  return file.string() + ".backup-" + std::to_string(version);
}

std::unique_ptr<Database> open_migrated(const std::filesystem::path& file,
                                        std::span<const Migration> migrations, Keep keep) {
  auto database = std::make_unique<Database>(file, Access::ReadWrite);
  const std::int64_t version = known_schema(*database, file, migrations);
  if (keep == Keep::Copy && version > 0 && version < std::ssize(migrations))
    keep_copy_of(*database, file, version);
  // The size of pages counts for a new file only.
  database->execute("PRAGMA page_size = 4096; PRAGMA foreign_keys = ON; PRAGMA synchronous = FULL");
  if (keep == Keep::Copy)
    database->execute("PRAGMA journal_mode = WAL");
  for (const Migration& migration : migrations.subspan(static_cast<std::size_t>(version)))
    apply(*database, file, migration, version > 0);
  database->keep_checksums();
  return database;
}

void check_schema(Database& database, const std::filesystem::path& file,
                  std::span<const Migration> migrations) {
  const std::int64_t version = checked_version(database, file, migrations);
  if (version != static_cast<std::int64_t>(migrations.size()))
    refuse_store(file, "has schema " + std::to_string(version) + " instead of " +
                           std::to_string(migrations.size()));
  check_history(database, file, version, migrations);
}

}  // namespace kinship::store
