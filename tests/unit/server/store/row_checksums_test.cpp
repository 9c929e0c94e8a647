#include <gtest/gtest.h>

#include <sqlite3.h>

#include <array>
#include <string>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::row_checksums_test {
namespace {

/// As `sqlite3 FILE SQL` does.
std::string run_sqlite(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* other = nullptr;
  EXPECT_EQ(sqlite3_open(file.c_str(), &other), SQLITE_OK);
  std::string answer;
  const auto take = [](void* text, int, char** values, char**) {
    static_cast<std::string*>(text)->append(values[0] == nullptr ? "" : values[0]);
    return 0;
  };
  EXPECT_EQ(sqlite3_exec(other, sql.c_str(), take, &answer, nullptr), SQLITE_OK)
      << sqlite3_errmsg(other);
  sqlite3_close(other);
  return answer;
}
class RowChecksums : public testing::Test {
 protected:
  RowChecksums() {
    database_.execute(
        "CREATE TABLE task (id INTEGER PRIMARY KEY, name TEXT UNIQUE, weight REAL,"
        " row_crc32c INTEGER NOT NULL DEFAULT 0) STRICT;"
        "CREATE TABLE attempt (id INTEGER PRIMARY KEY, number INTEGER, scene BLOB,"
        " row_crc32c INTEGER NOT NULL DEFAULT 0) STRICT;"
        "CREATE TABLE plain (x)");
    database_.keep_checksums();
  }
  std::int64_t intact(const std::string& table) {
    return database_.integer("SELECT count(*) FROM " + table + " WHERE " +
                             database_.is_intact(table));
  }
  /// As a flipped bit does: without the triggers.
  void damage(const std::string& sql) const {
    Database(directory_ / "rows.db", Access::ReadWrite).execute(sql);
  }

  const test::TemporaryDirectory directory_;
  Database database_{directory_ / "rows.db", Access::Create};
};

TEST_F(RowChecksums, ARowThatIsWrittenHasItsChecksumAndAChangedOneANewOne) {
  database_.execute(
      "INSERT INTO task (name, weight) VALUES ('a', -0.0), ('b', NULL), ('c', 1e300)");
  EXPECT_EQ(intact("task"), 3);
  database_.execute("UPDATE task SET weight = weight + 1 WHERE name <> 'b'");
  database_.execute(
      "INSERT INTO task (name, weight) VALUES ('a', 5)"
      " ON CONFLICT (name) DO UPDATE SET weight = excluded.weight");
  EXPECT_EQ(intact("task"), 3);
}

TEST_F(RowChecksums, WhatIsChangedOtherwiseIsNotIntact) {
  for (const char* const sql :
       {"UPDATE task SET name = 'x' WHERE id = 1", "UPDATE task SET weight = 2 WHERE id = 2",
        "UPDATE task SET weight = NULL WHERE id = 3", "UPDATE task SET id = 9 WHERE id = 4"}) {
    database_.execute(
        "DELETE FROM task; INSERT INTO task VALUES (1, 'a', 1, 0), (2, 'b', 1, 0), (3, 'c', 1, 0),"
        " (4, 'd', 1, 0)");
    damage(sql);
    EXPECT_EQ(intact("task"), 3) << sql;
  }
}

TEST_F(RowChecksums, AnIndexThatLeadsToAnotherRowIsFound) {
  database_.execute("INSERT INTO task (name) VALUES ('a'), ('b')");
  // The entry of 'a' becomes one of 'c', which leads to the row of 'a'.
  run_sqlite(directory_ / "rows.db",
             "PRAGMA writable_schema = ON;"
             "CREATE TABLE twin (id INTEGER PRIMARY KEY, name TEXT UNIQUE); INSERT INTO twin VALUES"
             " (1, 'c'), (2, 'b');"
             "UPDATE sqlite_master SET rootpage = (SELECT rootpage FROM sqlite_master WHERE name ="
             " 'sqlite_autoindex_twin_1') WHERE name = 'sqlite_autoindex_task_1'");
  Database again(directory_ / "rows.db", Access::ReadOnly);
  EXPECT_EQ(again.integer("SELECT id FROM task WHERE name = 'c'"), 1) << "SQLite believes it";
  EXPECT_EQ(again.integer("SELECT id FROM task WHERE name = 'c' AND " + again.is_intact("task")),
            0);
  EXPECT_EQ(again.integer("SELECT id FROM task WHERE name = 'b' AND " + again.is_intact("task")),
            2);
}

TEST_F(RowChecksums, APartOfADamagedRowIsNotChanged) {
  database_.execute("INSERT INTO attempt (number, scene) VALUES (1, x'0102'), (2, x'03')");
  damage("UPDATE attempt SET number = 7 WHERE id = 1");
  try {
    database_.execute("UPDATE attempt SET scene = x'05' WHERE id = 1");
    FAIL() << "changed";
  } catch (const SqliteError& error) {
    EXPECT_TRUE(error.is_damage()) << error.what();
    EXPECT_FALSE(error.concerns_one_row());
  }
  database_.execute("UPDATE attempt SET scene = x'05' WHERE id = 2");
  EXPECT_EQ(intact("attempt"), 1);
}

TEST_F(RowChecksums, ALargeColumnCountsWithItsLength) {
  database_.insert_into("attempt")->bind_all(std::int64_t{1}, std::int64_t{2}, Bytes()).run();
  const std::array<std::uint8_t, 3> blob = {1, 2, 3};
  database_.insert_into("attempt")->bind_all(std::int64_t{2}, std::int64_t{2}, Bytes(blob)).run();
  EXPECT_EQ(intact("attempt"), 2);
  damage("UPDATE attempt SET scene = x'010204' WHERE id = 2");
  EXPECT_EQ(intact("attempt"), 2) << "it has a checksum of its own";
  damage("UPDATE attempt SET scene = x'01020304' WHERE id = 2");
  EXPECT_EQ(intact("attempt"), 1);
}

/// Other programs beside a store, as SQLite's own shell is one.
class OtherPrograms : public testing::Test {
 protected:
  OtherPrograms() {
    store_ = open_sqlite_store(file_);
    static_cast<void>(store_->register_robot(robot_));
    for (std::uint64_t number = 0; number < kReports; ++number)
      attempts_.push_back(test::make_attempt(robot_.digest, "shelf", number));
    test::report(*store_, attempts_);
  }
  void expect_whole(const std::filesystem::path& file) {
    const StoreCheck check = check_store(file, [](double) {});
    EXPECT_EQ(check.problems, 0U) << testing::PrintToString(check.messages);
    const std::unique_ptr<Store> store = open_sqlite_store(file);
    EXPECT_EQ(store->status().attempts, kReports);
    for (const Receipt& receipt : test::report(*store, attempts_))
      EXPECT_EQ(receipt.status, ReceiptStatus::Duplicate);
  }

  static constexpr std::uint64_t kReports = 50;
  const test::TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_ / "store.db";
  const RobotRecord robot_ = test::make_robot("panda", 1);
  std::vector<Attempt> attempts_;
  std::unique_ptr<Store> store_;
};

TEST_F(OtherPrograms, MayReadAndCopyAServedStore) {
  EXPECT_EQ(run_sqlite(file_, "SELECT count(*) FROM attempt"), std::to_string(kReports));
  EXPECT_EQ(run_sqlite(file_, "PRAGMA integrity_check"), "ok");
  const std::filesystem::path copy = directory_ / "copy.db";
  run_sqlite(file_, "VACUUM INTO '" + copy.string() + "'");
  expect_whole(copy);
  const std::filesystem::path pages = directory_ / "pages.db";
  sqlite3 *from = nullptr, *to = nullptr;
  ASSERT_EQ(sqlite3_open(file_.c_str(), &from), SQLITE_OK);
  ASSERT_EQ(sqlite3_open(pages.c_str(), &to), SQLITE_OK);
  sqlite3_backup* const backup = sqlite3_backup_init(to, "main", from, "main");
  EXPECT_EQ(sqlite3_backup_step(backup, -1), SQLITE_DONE);
  sqlite3_backup_finish(backup);
  sqlite3_close(from);
  sqlite3_close(to);
  expect_whole(pages);
  store_.reset();
  expect_whole(file_);
}

TEST_F(OtherPrograms, MayReadCheckpointAndVacuumAStoreBehindACrash) {
  const std::filesystem::path crashed = directory_ / "crashed.db";
  for (const char* const part : {"", "-wal"})
    std::filesystem::copy_file(file_.string() + part, crashed.string() + part);
  EXPECT_EQ(run_sqlite(crashed, "SELECT count(*) FROM attempt"), std::to_string(kReports));
  expect_whole(crashed);
  run_sqlite(crashed, "PRAGMA wal_checkpoint(TRUNCATE); VACUUM; ANALYZE");
  expect_whole(crashed);
  EXPECT_TRUE(repair_store(crashed, [](double) {}).lost.empty());
  expect_whole(crashed);
}

}  // namespace
}  // namespace kinship::store::row_checksums_test
