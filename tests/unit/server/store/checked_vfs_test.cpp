#include "server/store/sqlite/database/checked_vfs.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/store/sqlite/database/online_backup.hpp"
#include "server/store/sqlite/database/page_seal.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::checked_vfs_test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPageSize = 4096;

/// Flips one bit of a file. Whoever has it open keeps his locks: they are another process's.
void flip(const fs::path& file, std::uint64_t offset, unsigned bit = 3) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(offset));
  const int byte = stream.get();
  stream.seekp(static_cast<std::streamoff>(offset));
  stream.put(static_cast<char>(byte ^ (1 << bit)));
  ASSERT_TRUE(stream.good());
}

std::vector<std::uint8_t> page_of(const fs::path& file, std::uint64_t number) {
  std::vector<std::uint8_t> page(kPageSize);
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>((number - 1) * kPageSize));
  stream.read(reinterpret_cast<char*>(page.data()), static_cast<std::streamsize>(page.size()));
  EXPECT_TRUE(stream.good());
  return page;
}

class CheckedVfs : public testing::Test {
 protected:
  CheckedVfs() {
    Database database(file_, Access::Create);
    database.execute("CREATE TABLE t (i INTEGER PRIMARY KEY, b BLOB)");
    fill(database, 200);
  }
  static void fill(Database& database, int rows) {
    Transaction transaction(database, Transaction::Kind::Write);
    const std::vector<std::uint8_t> blob(1000, 0x5A);
    for (int row = 0; row < rows; ++row)
      database.cached("INSERT INTO t (b) VALUES (?)")->bind(1, Bytes(blob)).run();
    transaction.commit();
  }
  static int code_of_reading(Database& database) {
    try {
      database.integer("SELECT sum(length(b)) FROM t");
    } catch (const SqliteError& error) {
      return error.sqlite_code();
    }
    return SQLITE_OK;
  }
  static std::uint64_t pages_of(const fs::path& file) { return fs::file_size(file) / kPageSize; }

  const test::TemporaryDirectory directory_;
  const fs::path file_ = directory_ / "t.db";
};

TEST_F(CheckedVfs, SealsEveryPage) {
  ASSERT_GT(pages_of(file_), 20U);
  for (std::uint64_t page = 1; page <= pages_of(file_); ++page)
    EXPECT_TRUE(is_sealed(page_of(file_, page), page)) << page;
}

TEST_F(CheckedVfs, RefusesAPageWithAFlippedBitNamesItAndReadsTheOthers) {
  flip(file_, 10 * kPageSize + 77);
  Database database(file_, Access::ReadOnly);
  EXPECT_EQ(code_of_reading(database), kDamagedPage);
  EXPECT_EQ(damage_of(database.connection())->pages(), std::vector<std::uint64_t>{11});
  EXPECT_EQ(database.integer("SELECT length(b) FROM t WHERE i = 1"), 1000);
}

TEST_F(CheckedVfs, RefusesAPageInAnothersPlace) {
  const std::vector<std::uint8_t> page = page_of(file_, 8);
  {
    std::fstream stream(file_, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(8 * kPageSize);
    stream.write(reinterpret_cast<const char*>(page.data()), kPageSize);
  }
  Database database(file_, Access::ReadOnly);
  EXPECT_EQ(code_of_reading(database), kDamagedPage);
}

TEST_F(CheckedVfs, RefusesAHeaderWithAFlippedBitWhicheverItIs) {
  for (std::uint64_t byte = 0; byte < 100; ++byte)
    for (unsigned bit = 0; bit < 8; ++bit) {
      flip(file_, byte, bit);
      Database database(file_, Access::ReadOnly);
      EXPECT_NE(code_of_reading(database), SQLITE_OK) << "byte " << byte << ", bit " << bit;
      flip(file_, byte, bit);
    }
}

TEST_F(CheckedVfs, LeavesAFileWithoutRoomForSealsAsItIs) {
  const fs::path plain = directory_ / "plain.db";
  sqlite3* connection = nullptr;
  ASSERT_EQ(sqlite3_open(plain.c_str(), &connection), SQLITE_OK);
  sqlite3_exec(connection, "CREATE TABLE t (i INTEGER PRIMARY KEY, b BLOB)", nullptr, nullptr,
               nullptr);
  sqlite3_close(connection);
  Database database(plain, Access::ReadWrite);
  fill(database, 200);
  EXPECT_EQ(code_of_reading(database), SQLITE_OK);
  EXPECT_FALSE(is_sealed(database.connection()));
  EXPECT_FALSE(bears_seal(page_of(plain, 5)));
  const fs::path copy = directory_ / "copy.db";
  std::ofstream(copy).close();
  copy_database(database, copy, [](double) {});
  EXPECT_FALSE(bears_seal(page_of(copy, 5)));
  Database copied(copy, Access::ReadOnly);
  EXPECT_EQ(code_of_reading(copied), SQLITE_OK);
  EXPECT_EQ(copied.integer("SELECT integrity_check = 'ok' FROM pragma_integrity_check"), 1);
}

TEST_F(CheckedVfs, ACopyOfManyPagesIsSealedToo) {
  {
    Database database(file_, Access::ReadWrite);
    fill(database, 4000);  // more than a cache holds: pages go to the file before the header does
    database.execute("DELETE FROM t WHERE i > 3000");
  }
  Database source(file_, Access::ReadOnly);
  const fs::path copy = directory_ / "copy.db";
  std::ofstream(copy).close();
  copy_database(source, copy, [](double) {});
  Database copied(copy, Access::ReadOnly);
  EXPECT_EQ(code_of_reading(copied), SQLITE_OK);
  EXPECT_EQ(copied.integer("SELECT integrity_check = 'ok' FROM pragma_integrity_check"), 1);
  EXPECT_TRUE(is_sealed(page_of(copy, 2), 2));
}

TEST_F(CheckedVfs, WhatIsRolledBackIsSealed) {
  {
    Database database(file_, Access::ReadWrite);
    database.execute("PRAGMA cache_size = 5; BEGIN; UPDATE t SET b = zeroblob(900); ROLLBACK");
    EXPECT_EQ(code_of_reading(database), SQLITE_OK);
  }
  Database database(file_, Access::ReadOnly);
  EXPECT_EQ(database.integer("SELECT sum(length(b)) FROM t"), 200'000);
}

/// A page that is damaged in the WAL, while its writer has it open.
class CheckedWal : public CheckedVfs {
 protected:
  CheckedWal() {
    writer_.execute("PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 0");
    fill(writer_, 20);
    reader_ = std::make_unique<Database>(file_, Access::ReadOnly);
  }
  const fs::path wal_ = file_.string() + "-wal";
  Database writer_{file_, Access::ReadWrite};
  std::unique_ptr<Database> reader_;
};

TEST_F(CheckedWal, IsRefused) {
  EXPECT_EQ(code_of_reading(*reader_), SQLITE_OK);
  reader_ = std::make_unique<Database>(file_, Access::ReadOnly);  // with an empty cache
  flip(wal_, fs::file_size(wal_) - 2000);
  EXPECT_EQ(code_of_reading(*reader_), kDamagedPage);
}

TEST_F(CheckedWal, IsNotBlessedByACheckpoint) {
  flip(wal_, fs::file_size(wal_) - 2000);
  writer_.execute("PRAGMA wal_checkpoint(TRUNCATE)");
  EXPECT_EQ(fs::file_size(wal_), 0U);  // the others are not held up by it
  reader_ = std::make_unique<Database>(file_, Access::ReadOnly);
  EXPECT_EQ(code_of_reading(*reader_), kDamagedPage);
  EXPECT_EQ(damage_of(reader_->connection())->pages().size(), 1U);
}

TEST_F(CheckedWal, IsWrittenAnewWithItsNextVersion) {
  reader_.reset();
  for (int round = 0; round < 5; ++round) {
    fill(writer_, 20);
    writer_.execute("PRAGMA wal_checkpoint(RESTART)");
  }
  Database reader(file_, Access::ReadOnly);
  EXPECT_EQ(code_of_reading(reader), SQLITE_OK);
  EXPECT_TRUE(damage_of(reader.connection())->pages().empty());
}

TEST_F(CheckedWal, IsReadAfterARecovery) {
  const fs::path copy = directory_ / "killed.db";
  fs::copy_file(file_, copy);
  fs::copy_file(wal_, copy.string() + "-wal");
  Database killed(copy, Access::ReadWrite);
  EXPECT_EQ(killed.integer("SELECT sum(length(b)) FROM t"), 220'000);
  killed.execute("PRAGMA wal_checkpoint(TRUNCATE)");
  Database reader(copy, Access::ReadOnly);
  EXPECT_EQ(code_of_reading(reader), SQLITE_OK);
}

/// Calls that wrote something, of this process so far.
std::uint64_t write_calls() {
  std::ifstream io("/proc/self/io");
  for (std::string word; io >> word;)
    if (std::uint64_t count = 0; word == "syscw:" && io >> count)
      return count;
  throw std::runtime_error("no /proc/self/io");
}

class GatheredWal : public CheckedVfs {
 protected:
  GatheredWal() {
    database_.execute("PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 0");
    fill(database_, 1);  // the WAL has its header
  }
  std::uint64_t write_calls_of(int rows) {
    const std::uint64_t before = write_calls();
    fill(database_, rows);
    return write_calls() - before;
  }
  std::int64_t rows_for_others() const {
    Database other(file_, Access::ReadOnly);
    return other.integer("SELECT count(*) FROM t WHERE length(b) = 1000");
  }
  Database database_{file_, Access::ReadWrite};
};

TEST_F(GatheredWal, IsWrittenInOneCallACommit) {
  EXPECT_GT(write_calls_of(100), 50U);
  gather_wal_writes(database_.connection());
  EXPECT_LE(write_calls_of(100), 3U);
  EXPECT_EQ(rows_for_others(), 401);
}

TEST_F(GatheredWal, IsNotGatheredByWhoDoesNotSync) {
  database_.execute("PRAGMA synchronous = NORMAL");
  gather_wal_writes(database_.connection());
  EXPECT_GT(write_calls_of(100), 50U);
  EXPECT_EQ(rows_for_others(), 301);
}

TEST_F(GatheredWal, IsReadBackByATransactionThatOutgrowsItsCache) {
  database_.execute("PRAGMA cache_size = 10");
  gather_wal_writes(database_.connection());
  {
    Transaction transaction(database_, Transaction::Kind::Write);
    database_.execute("UPDATE t SET b = zeroblob(1000); UPDATE t SET b = zeroblob(1001)");
    EXPECT_EQ(database_.integer("SELECT sum(length(b)) FROM t"), 201 * 1001);
    EXPECT_EQ(rows_for_others(), 201);
  }  // undone
  EXPECT_EQ(database_.integer("SELECT sum(length(b)) FROM t"), 201 * 1000);
  fill(database_, 5);
  EXPECT_EQ(rows_for_others(), 206);
  EXPECT_EQ(database_.integer("SELECT integrity_check = 'ok' FROM pragma_integrity_check"), 1);
}

}  // namespace
}  // namespace kinship::store::checked_vfs_test
