#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/store/sqlite/database/row_checksums.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/opening/migrations.hpp"

/// The schema of today's stores and a made-up next one, for tests of migrations.
namespace kinship::test {

inline std::int64_t schema_of_today() { return std::ssize(store::embedded_migrations()); }

inline std::vector<store::Migration> with_next_schema() {
  const auto known = store::embedded_migrations();
  std::vector<store::Migration> migrations(known.begin(), known.end());
  migrations.push_back({schema_of_today() + 1, "made_up",
                        "CREATE TABLE made_up (x INTEGER PRIMARY KEY, y BLOB NOT NULL) STRICT;"
                        "INSERT INTO made_up SELECT id, waypoints FROM path;"
                        "ALTER TABLE task ADD COLUMN made_up INTEGER"});
  return migrations;
}

/// Makes a store of that schema one of today's again.
inline void undo_next_schema(const std::filesystem::path& file) {
  store::Database database(file, store::Access::ReadWrite);
  store::Transaction transaction(database, store::Transaction::Kind::Write);
  const std::string today = std::to_string(schema_of_today());
  database.execute(
      "DROP TABLE made_up; ALTER TABLE task DROP COLUMN made_up;"
      "DELETE FROM schema_migration WHERE version > " +
      today + "; PRAGMA user_version = " + today);
  const auto tables = store::read_checked_tables(database.connection());
  database.execute("UPDATE task SET row_crc32c = " + tables.at("task").checksum(""));
  transaction.commit();
}

}  // namespace kinship::test
