#include "server/store/sqlite/opening/migrations.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <array>
#include <fstream>
#include <string>
#include <vector>

#include "proto/types/failure.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/files/store_file.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::migrations_test {
namespace {

constexpr Migration kSecond{2, "0002_extra", "CREATE TABLE extra (x INTEGER) STRICT;"};
constexpr Migration kBroken{2, "0002_broken", "CREATE TABLE extra (x INTEGER); CREATE nonsense;"};

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

class Migrations : public testing::Test {
 protected:
  void run(std::span<const Migration> migrations) {
    make_for_owner(file_);
    open_migrated(file_, migrations);
  }
  std::string refusal(std::span<const Migration> migrations) {
    try {
      run(migrations);
    } catch (const Failure& failure) {
      return failure.what();
    }
    return "";
  }
  std::int64_t integer(const std::string& sql) {
    return Database(file_, Access::ReadOnly).integer(sql);
  }
  std::filesystem::path backup() const { return file_.string() + ".backup-1"; }

  const test::TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_ / "s.db";
  const Migration first_ = embedded_migrations()[0];
};

TEST_F(Migrations, AreNumberedFromOneWithoutGaps) {
  std::int64_t version = 0;
  for (const Migration& migration : embedded_migrations())
    EXPECT_EQ(migration.version, ++version) << migration.name;
}

TEST_F(Migrations, CarryTheTextOfTheSchemaFolder) {
  for (const Migration& migration : embedded_migrations()) {
    const std::filesystem::path folder = test::source_dir() + "/schema/sqlite";
    EXPECT_EQ(migration.text, contents(folder / (std::string(migration.name) + ".sql")));
  }
}

TEST_F(Migrations, MakeAStoreOnceAndThenLeaveItAlone) {
  run(embedded_migrations());
  EXPECT_EQ(integer("PRAGMA user_version"), std::ssize(embedded_migrations()));
  EXPECT_EQ(integer("PRAGMA application_id"), 0x4B494E53);
  const std::string bytes = contents(file_);
  run(embedded_migrations());
  EXPECT_EQ(contents(file_), bytes);
  EXPECT_FALSE(std::filesystem::exists(backup()));
}

TEST_F(Migrations, OfAStoreThatWasThereAreInItsAuditLog) {
  const auto entries = [this](const std::string& before, const std::string& after) {
    return integer("SELECT count(*) FROM audit WHERE verb = 'migrate' AND outcome = 2 AND was = '" +
                   before + "' AND became = '" + after + "' AND target = '" + file_.string() +
                   "' AND client LIKE 'kinshipd of user %'");
  };
  const Migration third{3, "0003_more", "CREATE TABLE more (x INTEGER) STRICT;"};
  run(std::array{first_});
  EXPECT_THROW(run(std::array{first_, kBroken}), SqliteError);
  EXPECT_EQ(integer("SELECT count(*) FROM audit"), 0) << "in the transaction of the migration";
  run(std::array{first_, kSecond, third});
  EXPECT_EQ(entries("schema 1", "schema 2"), 1);
  EXPECT_EQ(entries("schema 2", "schema 3"), 1);
  run(std::array{first_, kSecond, third});
  EXPECT_EQ(integer("SELECT count(*) FROM audit"), 2);
}

TEST_F(Migrations, OfANewStoreAreNot) {
  run(embedded_migrations());
  EXPECT_EQ(integer("SELECT count(*) FROM audit"), 0);
}

TEST_F(Migrations, KeepACopyOfAnOlderStore) {
  run(std::array{first_});
  Database(file_, Access::ReadWrite).execute("INSERT INTO task (id, name) VALUES (1, 'old')");
  run(std::array{first_, kSecond});
  EXPECT_EQ(integer("PRAGMA user_version"), 2);
  EXPECT_EQ(integer("SELECT count(*) FROM task"), 1);
  Database copy(backup(), Access::ReadOnly);
  EXPECT_EQ(copy.integer("PRAGMA user_version"), 1);
  EXPECT_EQ(copy.integer("SELECT count(*) FROM task"), 1);
}

TEST_F(Migrations, ThatAddAColumnLeaveRowsIntactOrDamagedAsTheyWere) {
  run(std::array{first_});
  {
    Database database(file_, Access::ReadWrite);
    database.keep_checksums();
    database.execute("INSERT INTO task (id, name) VALUES (1, 'kept'), (2, 'damaged')");
  }
  Database(file_, Access::ReadWrite).execute("UPDATE task SET name = 'changed' WHERE id = 2");
  run(std::array{first_, Migration{2, "0002_wider",
                                   "ALTER TABLE task ADD COLUMN note TEXT NOT NULL DEFAULT '';"}});
  Database migrated(file_, Access::ReadOnly);
  EXPECT_EQ(migrated.integer("SELECT sum(id) FROM task WHERE " + migrated.is_intact("task")), 1);
}

TEST_F(Migrations, OfACopyKeepNoCopyOfIt) {
  run(std::array{first_});
  open_migrated(file_, std::array{first_, kSecond}, Keep::Nothing);
  EXPECT_EQ(integer("PRAGMA user_version"), 2);
  EXPECT_FALSE(std::filesystem::exists(backup()));
}

TEST_F(Migrations, ThatFailLeaveNothingBehind) {
  run(std::array{first_});
  EXPECT_THROW(run(std::array{first_, kBroken}), SqliteError);
  EXPECT_EQ(integer("PRAGMA user_version"), 1);
  EXPECT_EQ(integer("SELECT count(*) FROM sqlite_master WHERE name = 'extra'"), 0);
  run(std::array{first_, kSecond});  // over the backup of the first try
  EXPECT_EQ(integer("PRAGMA user_version"), 2);
}

TEST_F(Migrations, RefuseANewerStore) {
  run(std::array{first_, kSecond});
  EXPECT_NE(refusal(std::array{first_})
                .find("has schema 2; this binary knows up to 1; serve it with the program that "
                      "wrote it, 'kinship paths export' there and 'kinship paths import'"),
            std::string::npos)
      << refusal(std::array{first_});
  EXPECT_EQ(integer("PRAGMA user_version"), 2);
}

TEST_F(Migrations, RefuseAnEditedHistory) {
  run(std::array{first_});
  Migration edited = first_;
  edited.text = "-- another text";
  const std::string why = refusal(std::array{edited, kSecond});
  EXPECT_NE(why.find("another text of migration 1"), std::string::npos) << why;
  EXPECT_NE(why.find("'kinship paths export'"), std::string::npos) << why;
  EXPECT_FALSE(std::filesystem::exists(backup()));
  Database(file_, Access::ReadWrite).execute("DELETE FROM schema_migration");
  EXPECT_NE(refusal(std::array{first_}).find("records migrations up to 0"), std::string::npos);
}

TEST_F(Migrations, RefuseAFileOfSomebodyElse) {
  Database(file_, Access::Create).execute("CREATE TABLE t (x)");
  EXPECT_NE(refusal(embedded_migrations()).find("no Kinship store"), std::string::npos);
  EXPECT_EQ(integer("SELECT count(*) FROM sqlite_master"), 1);
  std::filesystem::remove(file_);
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(file_.c_str(), &other), SQLITE_OK);
  sqlite3_exec(other, "VACUUM", nullptr, nullptr, nullptr);
  sqlite3_close(other);
  EXPECT_EQ(refusal(embedded_migrations()), "") << "nobody's file yet";
  std::ofstream(file_) << std::string(5000, 'x');
  EXPECT_NE(refusal(embedded_migrations()).find("no SQLite database"), std::string::npos);
}

}  // namespace
}  // namespace kinship::store::migrations_test
