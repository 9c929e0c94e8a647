// What the database refuses of reports that break no rule: they wait, and nothing waits with them.

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <thread>

#include "proto/types/hex.hpp"
#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/opening/migrations.hpp"
#include "server/store/postgres/postgres_store.hpp"
#include "server/store/report_digests.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/small_file_system.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/store/postgres/fresh_database.hpp"

namespace kinship::store::postgres {
namespace {

using namespace std::chrono_literals;

class DatabaseTroubles : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    url_ = FreshDatabases::of_program().url(folder_.path());
    store_ = open_postgres_store(url_, {.retry_after = 1ms, .put_off_for = 0ms});
    EXPECT_TRUE(store_->register_robot(robot_));
  }
  Attempt attempt(std::uint64_t number) const {
    return test::make_attempt(robot_.digest, "shelf", number);
  }
  std::string sql(const std::string& text) const {
    FreshDatabases& databases = FreshDatabases::of_program();
    return databases.cluster().query(text, databases.name(folder_.path()));
  }
  static std::string literal(const Uuid& uuid) { return "'\\x" + to_hex(uuid.bytes) + "'"; }
  /// As clients do, once the trouble is over.
  void report_until_all_are_taken(const std::vector<Attempt>& attempts) {
    const auto is_open = [](const Receipt& receipt) {
      EXPECT_NE(receipt.status, ReceiptStatus::Refused) << receipt.message;
      return receipt.status == ReceiptStatus::TryAgain;
    };
    constexpr int kTries = 10'000;
    for (int i = 0; i < kTries; ++i)
      if (std::ranges::none_of(test::report(*store_, attempts), is_open))
        return;
    FAIL() << store_->status().message;
  }

  const test::TemporaryDirectory folder_;
  const RobotRecord robot_ = test::make_robot("panda", 1);
  const Attempt poison_ = attempt(2);
  std::string url_;
  std::unique_ptr<Store> store_;
};

TEST(ErrorClasses, AreThoseOfAppendixA) {
  const std::vector<std::string_view> appendix = {
      "00", "01", "02", "03", "08", "09", "0A", "0B", "0F", "0L", "0P", "0Z", "20", "21", "22",
      "23", "24", "25", "26", "27", "28", "2B", "2D", "2F", "34", "38", "39", "3B", "3D", "3F",
      "40", "42", "44", "53", "54", "55", "57", "58", "72", "F0", "HV", "P0", "XX"};
  std::vector<std::string_view> classes;
  for (const ErrorClass& each : kErrorClasses)
    if (each.begin.size() == 2)
      classes.push_back(each.begin);
  EXPECT_EQ(classes, appendix);
  EXPECT_EQ(kind_of(""), ErrorKind::Lost) << "the connection died without a word";
  EXPECT_EQ(kind_of("ZZ000"), ErrorKind::Other);
  EXPECT_EQ(kind_of("40001"), ErrorKind::Conflict) << "the longest beginning counts";
}

/// Each class, raised by an administrator's trigger for one report of three.
class EachErrorClass : public DatabaseTroubles, public testing::WithParamInterface<ErrorClass> {};

std::string name_of(const testing::TestParamInfo<ErrorClass>& each) {
  return "Of" + std::string(each.param.begin);
}
INSTANTIATE_TEST_SUITE_P(Appendix, EachErrorClass, testing::ValuesIn(kErrorClasses), name_of);

TEST_P(EachErrorClass, RefusesNothingIsNamedAndPasses) {
  constexpr std::size_t kCodeBytes = 5;
  std::string code(GetParam().begin);
  code.resize(kCodeBytes, '9');
  ASSERT_EQ(kind_of(code), GetParam().kind);
  if (code.starts_with("00"))
    return;  // success: nothing raises it
  sql("CREATE FUNCTION object() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN"
      " IF NEW.report_uuid = " +
      literal(poison_.report_uuid) +
      " THEN RAISE EXCEPTION 'the administrator objects' USING ERRCODE = '" + code +
      "'; END IF; RETURN NEW; END $$;"
      "CREATE TRIGGER object BEFORE INSERT ON attempt FOR EACH ROW EXECUTE FUNCTION object()");
  const std::vector<Attempt> attempts = {attempt(1), poison_, attempt(3)};
  const std::vector<Receipt> receipts = test::report(*store_, attempts);
  const std::string told = store_->status().message;
  EXPECT_NE(told.find(code), std::string::npos) << told;
  EXPECT_EQ(receipts[1].status, ReceiptStatus::TryAgain);
  EXPECT_NE(receipts[1].message.find("the administrator objects"), std::string::npos)
      << receipts[1].message;
  const bool is_alone = GetParam().kind == ErrorKind::OneRow;
  EXPECT_EQ(told.find("put off") != std::string::npos, is_alone) << told;
  for (const std::size_t other : {0U, 2U})
    EXPECT_EQ(receipts[other].status, is_alone ? ReceiptStatus::Stored : ReceiptStatus::TryAgain);
  sql("DROP TRIGGER object ON attempt");
  report_until_all_are_taken(attempts);
  EXPECT_EQ(sql("SELECT count(*) FROM attempt"), "3");
}

/// What an administrator did to the database, the code of what comes of it for one report of three,
/// and how it is undone. UUIDS: the good ones; POISON: the other one.
struct Doing {
  std::string name, done, code, undone;
};

class AdministratorsHand : public DatabaseTroubles, public testing::WithParamInterface<Doing> {};

const std::vector<Doing> kDoings = {
    {"Check", "ALTER TABLE attempt ADD CONSTRAINT hand CHECK (report_uuid <> POISON)", "23514",
     "ALTER TABLE attempt DROP CONSTRAINT hand"},
    {"ForeignKey",
     "CREATE TABLE known (report_uuid bytea PRIMARY KEY); INSERT INTO known VALUES UUIDS;"
     "ALTER TABLE attempt ADD CONSTRAINT hand FOREIGN KEY (report_uuid) REFERENCES known",
     "23503", "ALTER TABLE attempt DROP CONSTRAINT hand"},
    {"AtTheCommit",
     "CREATE TABLE known (report_uuid bytea PRIMARY KEY); INSERT INTO known VALUES UUIDS;"
     "ALTER TABLE attempt ADD CONSTRAINT hand FOREIGN KEY (report_uuid) REFERENCES known"
     " DEFERRABLE INITIALLY DEFERRED",
     "23503", "ALTER TABLE attempt DROP CONSTRAINT hand"},
    {"Unique",
     "CREATE TABLE taken (report_uuid bytea PRIMARY KEY); INSERT INTO taken VALUES (POISON);"
     "CREATE FUNCTION hand() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN"
     " INSERT INTO taken VALUES (NEW.report_uuid); RETURN NEW; END $$;"
     "CREATE TRIGGER hand BEFORE INSERT ON attempt FOR EACH ROW EXECUTE FUNCTION hand()",
     "23505", "DROP TRIGGER hand ON attempt"},
    {"TakenAway",
     "CREATE FUNCTION hand() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN"
     " RETURN CASE WHEN NEW.report_uuid = POISON THEN NULL ELSE NEW END; END $$;"
     "CREATE TRIGGER hand BEFORE INSERT ON attempt FOR EACH ROW EXECUTE FUNCTION hand()",
     "takes reports away", "DROP TRIGGER hand ON attempt"},
    {"Arithmetic",
     "CREATE FUNCTION hand() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN"
     " IF NEW.report_uuid = POISON THEN NEW.resent := 1 / NEW.resent; END IF; RETURN NEW; END $$;"
     "CREATE TRIGGER hand BEFORE INSERT ON attempt FOR EACH ROW EXECUTE FUNCTION hand()",
     "22012", "DROP TRIGGER hand ON attempt"}};

INSTANTIATE_TEST_SUITE_P(Of, AdministratorsHand, testing::ValuesIn(kDoings),
                         [](const testing::TestParamInfo<Doing>& each) { return each.param.name; });

TEST_P(AdministratorsHand, PutsOffTheReportThatItHitsAlone) {
  const std::vector<Attempt> attempts = {attempt(1), poison_, attempt(3)};
  std::string done = GetParam().done;
  for (const auto& [word, value] :
       {std::pair<std::string, std::string>{"POISON", literal(poison_.report_uuid)},
        {"UUIDS",
         "(" + literal(attempts[0].report_uuid) + "), (" + literal(attempts[2].report_uuid) + ")"}})
    if (const std::size_t place = done.find(word); place != std::string::npos)
      done.replace(place, word.size(), value);
  sql(done);
  const std::vector<Receipt> receipts = test::report(*store_, attempts);
  EXPECT_EQ(receipts[0].status, ReceiptStatus::Stored) << receipts[0].message;
  EXPECT_EQ(receipts[1].status, ReceiptStatus::TryAgain) << receipts[1].message;
  EXPECT_EQ(receipts[2].status, ReceiptStatus::Stored) << receipts[2].message;
  const StoreStatus status = store_->status();
  EXPECT_TRUE(status.writable) << "it takes others";
  EXPECT_NE(status.message.find("put off 1 time since the start"), std::string::npos)
      << status.message;
  EXPECT_NE(status.message.find(GetParam().code), std::string::npos) << status.message;
  sql(GetParam().undone);
  report_until_all_are_taken(attempts);
  EXPECT_EQ(sql("SELECT count(*) FROM attempt"), "3");
}

TEST_F(DatabaseTroubles, ASequenceThatIsBehindIsMended) {
  constexpr std::uint64_t kBefore = 100;
  for (std::uint64_t number = 1; number <= kBefore; ++number)
    test::report(*store_, {attempt(number)});
  sql("ALTER TABLE attempt ALTER COLUMN id RESTART WITH 1");
  const std::vector<Attempt> attempts = {attempt(1001), attempt(1002)};
  for (const Receipt& receipt : test::report(*store_, attempts)) {
    EXPECT_EQ(receipt.status, ReceiptStatus::TryAgain);
    EXPECT_NE(receipt.message.find("[23505]"), std::string::npos) << receipt.message;
  }
  EXPECT_NE(store_->status().message.find("put off 2 times"), std::string::npos);
  sql("SELECT setval(pg_get_serial_sequence('attempt', 'id'), max(id)) FROM attempt");
  report_until_all_are_taken(attempts);
}

TEST_F(DatabaseTroubles, AColumnOfANewerSchemaIsNoFaultOfReports) {
  sql("ALTER TABLE attempt ADD COLUMN newer text NOT NULL");
  const Receipt receipt = test::report(*store_, {attempt(1)}).at(0);
  EXPECT_EQ(receipt.status, ReceiptStatus::TryAgain);
  EXPECT_NE(receipt.message.find("[23502]"), std::string::npos) << receipt.message;
  sql("ALTER TABLE attempt DROP COLUMN newer");
  report_until_all_are_taken({attempt(1)});
}

TEST_F(DatabaseTroubles, WhatIsPutOffIsAnsweredFromMemoryForAWhile) {
  store_.reset();
  store_ = open_postgres_store(url_);
  sql("ALTER TABLE attempt ADD CONSTRAINT hand CHECK (report_uuid <> " +
      literal(poison_.report_uuid) + ")");
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(test::report(*store_, {poison_}).at(0).status, ReceiptStatus::TryAgain);
  EXPECT_NE(store_->status().message.find("put off 1 time since"), std::string::npos);
  EXPECT_TRUE(store_->why_put_off(poison_.report_uuid));
  EXPECT_FALSE(store_->why_put_off(attempt(1).report_uuid));
}

TEST(DatabaseOnAFullDisk, PutsEverythingOffUntilThereIsRoom) {
  if (const std::string missing = test::missing_postgres(); !missing.empty())
    GTEST_SKIP() << missing;
  const test::TemporaryDirectory folder;
  const test::SmallFileSystem disk(folder.path(), "2m");
  if (!disk.is_mounted())
    GTEST_SKIP() << disk.why();
  const test::PostgresCluster cluster;
  struct stat owner {};
  ASSERT_EQ(stat(cluster.folder().c_str(), &owner), 0);
  const std::filesystem::path space = folder / "space", ballast = folder / "ballast";
  std::filesystem::create_directory(space);
  ASSERT_EQ(chown(space.c_str(), owner.st_uid, owner.st_gid), 0);
  const auto store = open_postgres_store(cluster.create_database("full"),
                                         {.retry_after = 1ms, .put_off_for = 0ms});
  const RobotRecord robot = test::make_robot("panda", 1);
  ASSERT_TRUE(store->register_robot(robot));
  cluster.query("CREATE TABLESPACE small LOCATION '" + space.string() + "'");
  cluster.query("ALTER TABLE attempt SET TABLESPACE small", "full");
  {
    std::ofstream filling(ballast, std::ios::binary);
    while (filling << std::string(4096, 'x') << std::flush)
      continue;
  }
  const auto attempt = [&](std::uint64_t number) {
    return test::make_unsolved(robot.digest, "shelf", number);
  };
  constexpr std::uint64_t kMost = 10'000;
  std::uint64_t number = 0;
  Receipt receipt;
  do
    receipt = test::report(*store, {attempt(++number)}).at(0);
  while (receipt.status == ReceiptStatus::Recorded && number < kMost);
  EXPECT_EQ(receipt.status, ReceiptStatus::TryAgain);
  EXPECT_NE(receipt.message.find("[53100]"), std::string::npos) << receipt.message;
  const StoreStatus status = store->status();
  EXPECT_FALSE(status.writable);
  EXPECT_NE(status.message.find("[53100]"), std::string::npos) << status.message;
  std::filesystem::remove(ballast);
  for (std::uint64_t i = 0; i < kMost && receipt.status == ReceiptStatus::TryAgain; ++i)
    receipt = test::report(*store, {attempt(number)}).at(0);
  EXPECT_EQ(receipt.status, ReceiptStatus::Recorded) << receipt.message;
  EXPECT_EQ(cluster.query("SELECT count(*) FROM attempt", "full"), std::to_string(number));
}

/// A newer server migrates the database that this one serves.
class NewerSchema : public DatabaseTroubles {
 protected:
  static std::vector<Migration> newer(std::string_view text) {
    const auto known = embedded_migrations();
    std::vector<Migration> migrations(known.begin(), known.end());
    migrations.push_back({std::ssize(known) + 1, "newer", text});
    return migrations;
  }
  void migrate_to(std::string_view text) const {
    Connection connection{ConnectionString(url_)};
    migrate(connection, newer(text));
  }
};

TEST_F(NewerSchema, EndsEveryWriteOfAnOlderServer) {
  test::report(*store_, {attempt(1)});
  migrate_to("CREATE TABLE newer (id bigint)");
  const Receipt receipt = test::report(*store_, {attempt(2)}).at(0);
  EXPECT_EQ(receipt.status, ReceiptStatus::TryAgain);
  EXPECT_NE(receipt.message.find("this binary knows up to"), std::string::npos) << receipt.message;
  EXPECT_THROW(static_cast<void>(store_->register_robot(test::make_robot("iiwa", 2))), Failure);
  EXPECT_THROW(static_cast<void>(store_->reset_task("shelf")), Failure);
  const StoreStatus status = store_->status();
  EXPECT_FALSE(status.writable);
  EXPECT_NE(status.message.find("not writable: the database has schema"), std::string::npos)
      << status.message;
  EXPECT_EQ(sql("SELECT count(*) FROM attempt"), "1");
  EXPECT_EQ(sql("SELECT count(*) FROM robot"), "1");
}

/// What opening a store to serve it would change.
constexpr const char* kMarks =
    "SELECT (SELECT count(*) FROM schema_migration) || ' ' || (SELECT count(*) FROM run) || ' ' ||"
    " (SELECT count(*) FROM audit)";

TEST_F(NewerSchema, IsReadByNoOlderBinary) {
  migrate_to("CREATE TABLE newer (id bigint)");
  const std::string before = sql(kMarks);
  try {
    open_report_digests(url_);
    FAIL() << "it was opened";
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find("has schema"), std::string::npos) << failure.what();
  }
  EXPECT_EQ(sql(kMarks), before);
}

TEST_F(DatabaseTroubles, ReadingDigestsChangesNothing) {
  test::report(*store_, {attempt(1), attempt(2)});
  const std::string before = sql(kMarks);
  const auto digests = open_report_digests(url_);
  EXPECT_EQ(digests->list_arrivals("", 10).rows.size(), 2U);
  const std::vector<Uuid> asked = {attempt(1).report_uuid, attempt(3).report_uuid};
  EXPECT_EQ(digests->known_reports(asked).size(), 1U);
  EXPECT_EQ(sql(kMarks), before);
}

TEST_F(DatabaseTroubles, ReadingDigestsMigratesNoOlderStore) {
  FreshDatabases& databases = FreshDatabases::of_program();
  const std::string url = databases.cluster().create_database("older");
  const std::string empty = databases.cluster().create_database("no_store");
  {
    Connection connection{ConnectionString(url)};
    migrate(connection, embedded_migrations().first(embedded_migrations().size() - 1));
  }
  const std::string before = databases.cluster().query(kMarks, "older");
  EXPECT_THROW(open_report_digests(url), Failure);
  EXPECT_EQ(databases.cluster().query(kMarks, "older"), before);
  EXPECT_THROW(open_report_digests(empty), Failure);
  EXPECT_EQ(databases.cluster().query("SELECT to_regclass('run') IS NULL", "no_store"), "t");
}

TEST_F(NewerSchema, IsNoticedByAnIdleServer) {
  migrate_to("CREATE TABLE newer (id bigint)");
  const auto until = std::chrono::steady_clock::now() + 30s;
  while (store_->status().writable && std::chrono::steady_clock::now() < until)
    std::this_thread::yield();
  EXPECT_NE(store_->status().message.find("not writable: the database has schema"),
            std::string::npos);
}

TEST_F(NewerSchema, FindsEveryReportThatAnOlderServerAcknowledges) {
  std::atomic<std::uint64_t> stored = 0;
  std::atomic<bool> is_ended = false;
  std::thread reporting([&] {
    constexpr std::uint64_t kMost = 5000;
    for (std::uint64_t number = 1; !is_ended && number < kMost; ++number)
      for (const Receipt& receipt : test::report(*store_, {attempt(number)})) {
        stored += receipt.status == ReceiptStatus::Stored ? 1U : 0U;
        is_ended = receipt.status == ReceiptStatus::TryAgain;
      }
  });
  while (stored < 20 && !is_ended)
    std::this_thread::yield();
  migrate_to("CREATE TABLE found AS SELECT count(*) AS reports FROM attempt");
  reporting.join();
  EXPECT_EQ(sql("SELECT reports FROM found"), std::to_string(stored));
  EXPECT_EQ(sql("SELECT count(*) FROM attempt"), std::to_string(stored));
}

}  // namespace
}  // namespace kinship::store::postgres
