#include "server/store/sqlite/database/database.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::database_test {
namespace {

class DatabaseTest : public testing::Test {
 protected:
  DatabaseTest() { database_.execute("CREATE TABLE t (i INTEGER UNIQUE, r REAL, s TEXT, b BLOB)"); }

  std::int64_t count() { return database_.integer("SELECT count(*) FROM t"); }
  void insert(std::int64_t i) {
    database_.cached("INSERT INTO t (i) VALUES (?)")->bind(1, i).run();
  }

  test::TemporaryDirectory directory_;
  Database database_{directory_ / "t.db", Access::Create};
};

TEST_F(DatabaseTest, GivesBackWhatWasBound) {
  const std::vector<std::uint8_t> bytes = {0, 1, 255};
  database_.cached("INSERT INTO t VALUES (?, ?, ?, ?)")
      ->bind_all(std::int64_t{-7}, 0.5, std::string_view("a\0b", 3), Bytes(bytes))
      .run();
  const auto query = database_.cached("SELECT i, r, s, b, NULL FROM t");
  ASSERT_TRUE(query->step());
  EXPECT_EQ(query->column_integer(0), -7);
  EXPECT_EQ(query->column_real(1), 0.5);
  EXPECT_EQ(query->column_text(2), std::string_view("a\0b", 3));
  EXPECT_TRUE(std::ranges::equal(query->column_blob(3), bytes));
  EXPECT_TRUE(query->column_is_null(4));
  EXPECT_FALSE(query->step());
}

TEST_F(DatabaseTest, EmptyTextAndBlobAreNotNull) {
  database_.cached("INSERT INTO t VALUES (1, NULL, ?, ?)")
      ->bind_all(std::string_view(), Bytes())
      .run();
  const auto query = database_.cached("SELECT s, b FROM t");
  ASSERT_TRUE(query->step());
  EXPECT_FALSE(query->column_is_null(0) || query->column_is_null(1));
}

TEST_F(DatabaseTest, ParametersOfASessionGoByTheirNumbers) {
  Session& session = database_;
  EXPECT_EQ(session.find_integer("SELECT $2 - $1 * $2", 3, 5), -10);
  EXPECT_EQ(session.find_integer("SELECT $1 WHERE $2", 1, false), std::nullopt);
  session.query("INSERT INTO t (s, i, b) VALUES ($2, $1, $3)", std::int64_t{7}, "seven",
                std::optional<Bytes>());
  for (const Row& row : session.query("SELECT i, s, b FROM t")) {
    EXPECT_EQ(row.column_integer(0), 7);
    EXPECT_EQ(row.column_text(1), "seven");
    EXPECT_TRUE(row.column_is_null(2));
  }
  EXPECT_THROW(session.query("SELECT $1", 1, 2), SqliteError);
}

TEST_F(DatabaseTest, TellsARowsErrorFromOneOfTheDatabase) {
  insert(1);
  try {
    insert(1);
    FAIL() << "two rows with one key";
  } catch (const SqliteError& error) {
    EXPECT_EQ(error.code(), ErrorCode::Storage);
    EXPECT_TRUE(error.concerns_one_row());
    EXPECT_NE(std::string(error.what()).find("UNIQUE"), std::string::npos) << error.what();
  }
  try {
    Database missing(directory_ / "missing.db", Access::ReadWrite);
    FAIL() << "opened a file that is not there";
  } catch (const SqliteError& error) {
    EXPECT_FALSE(error.concerns_one_row());
  }
}

TEST_F(DatabaseTest, AReturnedStatementHoldsNoSnapshot) {
  insert(1);
  insert(2);
  {
    const auto query = database_.cached("SELECT i FROM t");
    ASSERT_TRUE(query->step());  // and not to the end
  }
  EXPECT_FALSE(database_.cached("SELECT i FROM t WHERE i = ?")->step());  // bindings are gone too
  EXPECT_NO_THROW(database_.execute("PRAGMA journal_mode = WAL"));        // needs everybody out
}

TEST_F(DatabaseTest, ATransactionWithoutCommitLeavesNothing) {
  {
    Transaction transaction(database_, Transaction::Kind::Write);
    insert(1);
  }
  EXPECT_EQ(count(), 0);
  Transaction transaction(database_, Transaction::Kind::Write);
  insert(1);
  transaction.commit();
  EXPECT_EQ(count(), 1);
}

TEST_F(DatabaseTest, ASavepointUndoesItsOwnPartOnly) {
  Transaction transaction(database_, Transaction::Kind::Write);
  insert(1);
  {
    Savepoint outer(database_);
    insert(2);
    {
      Savepoint inner(database_);
      insert(3);
    }
    outer.keep();
  }
  {
    Savepoint undone(database_);
    insert(4);
  }
  transaction.commit();
  EXPECT_EQ(count(), 2);
}

TEST_F(DatabaseTest, AReadOnlyConnectionWritesNothing) {
  Database reader(directory_ / "t.db", Access::ReadOnly);
  EXPECT_THROW(reader.execute("INSERT INTO t (i) VALUES (1)"), SqliteError);
}

}  // namespace
}  // namespace kinship::store::database_test
