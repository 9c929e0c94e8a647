#include "server/store/postgres/postgres_store.hpp"

#include <gtest/gtest.h>

#include <future>

#include "server/store/postgres/opening/migrations.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/locked_table.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/unit/server/store/postgres/fresh_database.hpp"
#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store::postgres_store_test {
namespace {

std::unique_ptr<Store> open(const std::filesystem::path& folder,
                            const PostgresOptions& options = {}) {
  return open_postgres_store(FreshDatabases::of_program().url(folder), options);
}

/// None where PostgreSQL is not installed.
std::vector<Engine> postgres_engines() {
  if (!test::missing_postgres().empty())
    return {};
  const auto open_in = [](const std::filesystem::path& directory, const EngineLimits& limits) {
    if (const std::filesystem::path copy = directory / "store.db"; exists(copy))
      return open_sqlite_store(copy);  // a backup is one
    return open(directory, {.max_distribution_bytes = limits.distribution_bytes,
                            .max_paths_per_pair = limits.paths_per_pair,
                            .searches = limits.searches});
  };
  return {{"Postgres", open_in, Engine::BackupInstant::Begin}};
}
std::string name_of_postgres(const testing::TestParamInfo<Engine>& engine) {
  return engine.param.name;
}
INSTANTIATE_TEST_SUITE_P(Postgres, StoreConformance, testing::ValuesIn(postgres_engines()),
                         name_of_postgres);
INSTANTIATE_TEST_SUITE_P(Postgres, StoreRetention, testing::ValuesIn(postgres_engines()),
                         name_of_postgres);
INSTANTIATE_TEST_SUITE_P(Postgres, StoreBackup, testing::ValuesIn(postgres_engines()),
                         name_of_postgres);
INSTANTIATE_TEST_SUITE_P(Postgres, StoreRetentionBackup, testing::ValuesIn(postgres_engines()),
                         name_of_postgres);
INSTANTIATE_TEST_SUITE_P(Postgres, StoreSharing, testing::ValuesIn(postgres_engines()),
                         name_of_postgres);

/// What several servers on one database can show, and what becomes of one without its database.
class PostgresStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    store_ = open(folder_.path());
    EXPECT_TRUE(store_->register_robot(robot_));
  }
  std::unique_ptr<Store> another(const PostgresOptions& options = {}) const {
    return open(folder_.path(), options);
  }
  Attempt attempt(std::uint64_t number, const std::string& task = "shelf") const {
    return test::make_attempt(robot_.digest, task, number);
  }
  std::string sql(const std::string& text) const {
    FreshDatabases& databases = FreshDatabases::of_program();
    return databases.cluster().query(text, databases.name(folder_.path()));
  }
  /// Waits until what a reader handed to the writer is committed.
  void drain() { test::report(*store_, {}); }

  const test::TemporaryDirectory folder_;
  const RobotRecord robot_ = test::make_robot("panda", 1);
  std::unique_ptr<Store> store_;
};

TEST_F(PostgresStoreTest, TwoServersOnTheSameHotKeysLoseNothingAndCountEveryChange) {
  constexpr std::uint64_t kReports = 60;
  const std::unique_ptr<Store> other = another();
  // Both write the same four tasks, in opposite orders, and half of the contents are the same.
  const auto write = [&](Store& store, std::uint64_t first, bool backwards) {
    std::uint64_t stored = 0, duplicates = 0;
    for (std::uint64_t i = 0; i < kReports; ++i) {
      std::vector<Attempt> batch;
      for (std::uint64_t task = 0; task < 4; ++task) {
        const std::uint64_t which = backwards ? 3 - task : task;
        Attempt each = attempt(first + 4 * i + which, "task_" + std::to_string(which));
        if (i % 2 == 0)
          each.path = attempt(500'000 + i).path;
        batch.push_back(std::move(each));
      }
      for (const Receipt& receipt : test::report(store, batch)) {
        stored += receipt.status == ReceiptStatus::Stored ? 1U : 0U;
        duplicates += receipt.status == ReceiptStatus::Duplicate ? 1 : 0;
      }
    }
    return std::pair(stored, duplicates);
  };
  auto one = std::async(std::launch::async, [&] { return write(*store_, 1000, false); });
  auto two = std::async(std::launch::async, [&] { return write(*other, 100'000, true); });
  const auto [stored_one, duplicates_one] = one.get();
  const auto [stored_two, duplicates_two] = two.get();
  EXPECT_EQ(stored_one + stored_two + duplicates_one + duplicates_two, 2 * 4 * kReports);
  EXPECT_EQ(stored_one + stored_two, 4 * (kReports + kReports / 2)) << "half of them came twice";
  std::uint64_t generations = 0, paths = 0;
  for (int task = 0; task < 4; ++task) {
    const std::string name = "task_" + std::to_string(task);
    generations += other->generation(robot_.digest, name);
    const std::vector<std::int64_t> ids = store_->path_ids(robot_.digest, name);
    EXPECT_TRUE(std::ranges::is_sorted(ids));
    paths += ids.size();
  }
  EXPECT_EQ(generations, stored_one + stored_two) << "each batch brought a task at most one path";
  EXPECT_EQ(paths, stored_one + stored_two);
  EXPECT_EQ(sql("SELECT count(*) FROM attempt"), std::to_string(2 * 4 * kReports));
}

TEST_F(PostgresStoreTest, OneReportThatTwoServersGetIsStoredOnce) {
  constexpr std::uint64_t kReports = 100;
  const std::unique_ptr<Store> other = another();
  const auto write = [&](Store& store) {
    std::uint64_t stored = 0;
    for (std::uint64_t i = 1; i <= kReports; ++i)
      stored += test::report(store, {attempt(i)}).at(0).status == ReceiptStatus::Stored ? 1U : 0U;
    return stored;
  };
  auto one = std::async(std::launch::async, [&] { return write(*store_); });
  auto two = std::async(std::launch::async, [&] { return write(*other); });
  EXPECT_EQ(one.get() + two.get(), kReports);
  EXPECT_EQ(store_->status().attempts, kReports);
  EXPECT_EQ(store_->generation(robot_.digest, "shelf"), kReports);
}

TEST_F(PostgresStoreTest, OneUuidForTwoTasksAtTwoServersIsStoredOnceAndRefusedOnce) {
  constexpr std::uint64_t kReports = 100;
  const std::unique_ptr<Store> other = another();
  const auto write = [&](Store& store, const std::string& task) {
    std::uint64_t stored = 0;
    for (std::uint64_t i = 1; i <= kReports; ++i)
      stored +=
          test::report(store, {attempt(i, task)}).at(0).status == ReceiptStatus::Stored ? 1U : 0U;
    return stored;
  };
  auto one = std::async(std::launch::async, [&] { return write(*store_, "shelf"); });
  auto two = std::async(std::launch::async, [&] { return write(*other, "table"); });
  EXPECT_EQ(one.get() + two.get(), kReports);
  EXPECT_EQ(sql("SELECT count(*) FROM path"), std::to_string(kReports));
}

TEST_F(PostgresStoreTest, TwoServersKeepTheSmallestDigestsOfAll) {
  constexpr std::uint64_t kCap = 10, kReports = 60;
  const test::TemporaryDirectory elsewhere;
  const std::unique_ptr<Store> alone = open(elsewhere.path(), {.max_paths_per_pair = kCap});
  EXPECT_TRUE(alone->register_robot(robot_));
  const std::unique_ptr<Store> two = another({.max_paths_per_pair = kCap});
  store_ = another({.max_paths_per_pair = kCap});
  const auto write = [&](Store& store, std::uint64_t first, std::uint64_t step) {
    for (std::uint64_t i = first; i <= kReports; i += step)
      test::report(store, {attempt(i)});
  };
  auto odd = std::async(std::launch::async, [&] { write(*store_, 1, 2); });
  write(*two, 2, 2);
  odd.get();
  write(*alone, 1, 1);
  const auto kept = [&](const Store& store) {
    std::set<Uuid> uuids;
    for (const StoredPath& path : store.read_paths(robot_.digest, "shelf", {.limit = 1000}))
      uuids.insert(path.report_uuid);
    return uuids;
  };
  EXPECT_EQ(kept(*store_).size(), kCap);
  EXPECT_EQ(kept(*store_), kept(*alone));
}

TEST_F(PostgresStoreTest, WhatOneServerDoesTheOtherSees) {
  const std::unique_ptr<Store> other = another();
  test::report(*store_, {attempt(1), attempt(2)});
  EXPECT_EQ(other->generation(robot_.digest, "shelf"), 1U);
  EXPECT_EQ(other->reset_task("shelf")->paths, 2U);
  EXPECT_TRUE(store_->read_paths(robot_.digest, "shelf", {.limit = 10}).empty());
  EXPECT_TRUE(other->remove_robot(robot_.digest, {}, nullptr));
  EXPECT_EQ(test::report(*store_, {attempt(3)}).at(0).status, ReceiptStatus::UnknownRobot);
  EXPECT_EQ(*other->register_robot(robot_), RegisterStatus::Registered);
  EXPECT_EQ(*store_->register_robot(robot_), RegisterStatus::Known);
  EXPECT_EQ(test::report(*store_, {attempt(3)}).at(0).status, ReceiptStatus::Stored);
}

TEST_F(PostgresStoreTest, AMarkOfOneServerIsJudgedByTheOther) {
  const std::unique_ptr<Store> other = another();
  test::report(*store_, {attempt(1)});
  const ConsistencyToken token = store_->point().token;
  EXPECT_FALSE(other->has_lost(token));
  EXPECT_FALSE(other->begin_epoch_if_lost(token));
  // As after a promotion of a standby that had not got the last commit.
  sql("UPDATE run SET position = position - 1 WHERE position > 1");
  const std::unique_ptr<Store> third = another();
  EXPECT_TRUE(third->has_lost(token));
  const Uuid before = third->epoch();
  EXPECT_TRUE(third->begin_epoch_if_lost(token));
  EXPECT_NE(third->epoch(), before);
  EXPECT_FALSE(third->has_lost(token));
  EXPECT_FALSE(other->begin_epoch_if_lost(token)) << "one epoch for one loss";
  EXPECT_EQ(test::report(*store_, {attempt(2)}).at(0).status, ReceiptStatus::Stored);
  EXPECT_EQ(store_->epoch(), third->epoch());
  EXPECT_GT(store_->generation(robot_.digest, "shelf"), 1'000'000U);
  EXPECT_GT(store_->path_ids(robot_.digest, "shelf").back(), 1'000'000)
      << "no id of a path that was lost comes again";
}

TEST_F(PostgresStoreTest, GoesOnWhenItsConnectionsAreCut) {
  test::report(*store_, {attempt(1)});
  static_cast<void>(store_->status());
  sql("SELECT count(pg_terminate_backend(pid)) FROM pg_stat_activity"
      " WHERE datname = current_database() AND pid <> pg_backend_pid()");
  EXPECT_EQ(store_->generation(robot_.digest, "shelf"), 1U);
  EXPECT_EQ(*store_->register_robot(robot_), RegisterStatus::Known);
  store_ = another({.retry_after = std::chrono::milliseconds(1)});
  sql("SELECT count(pg_terminate_backend(pid)) FROM pg_stat_activity"
      " WHERE datname = current_database() AND pid <> pg_backend_pid()");
  ReceiptStatus status = ReceiptStatus::TryAgain;
  for (int tries = 0; tries < 1000 && status == ReceiptStatus::TryAgain; ++tries)
    status = test::report(*store_, {attempt(2)}).at(0).status;
  EXPECT_EQ(status, ReceiptStatus::Stored);
  EXPECT_EQ(store_->status().rollbacks, 0U);
  EXPECT_TRUE(store_->status().writable);
}

TEST_F(PostgresStoreTest, AReportThatComesWhileOthersRetireItIsRetired) {
  const std::unique_ptr<Store> other = another();
  Attempt report = attempt(1);
  report.scene = RecordedScene{{{"table", BoxShape{{1, 2, 0.1}}}}, {}, {}};
  std::future<std::vector<Receipt>> reported;
  std::future<std::vector<Retirement>> retired;
  {
    FreshDatabases& databases = FreshDatabases::of_program();
    const test::LockedTable scenes(databases.url(folder_.path()), "scene");
    reported = std::async(std::launch::async, [&] { return test::report(*store_, {report}); });
    // It has looked by now which of its reports are retired.
    scenes.wait_until_wanted_by(1);
    retired = std::async(std::launch::async,
                         [&] { return other->retire_reports(std::vector{report.report_uuid}); });
    const std::string waits =
        "SELECT EXISTS (SELECT FROM pg_locks WHERE locktype = 'advisory' AND NOT granted)";
    while (retired.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready &&
           sql(waits) != "t")
      continue;
  }
  EXPECT_EQ(reported.get().at(0).status, ReceiptStatus::Stored);
  EXPECT_EQ(retired.get().size(), 1U);
  EXPECT_TRUE(other->read_paths(robot_.digest, "shelf", {.limit = 10}).empty());
}

TEST_F(PostgresStoreTest, ARetiredPathIsToldAlsoWhereTheListLacksIt) {
  test::report(*store_, {attempt(1), attempt(2)});
  ASSERT_TRUE(store_->retire_path(attempt(1).report_uuid));
  sql("DELETE FROM retired_report");
  const Feed<ArrivedReport> feed = store_->list_arrivals("", "", 10);
  ASSERT_EQ(feed.rows.size(), 2U);
  EXPECT_TRUE(feed.rows[0].is_retired);
  EXPECT_FALSE(feed.rows[1].is_retired);
}

TEST_F(PostgresStoreTest, WhoStopsDoesNotWaitForADatabaseThatDoesNotAnswer) {
  test::report(*store_, {attempt(1)});
  const test::PostgresCluster& cluster = FreshDatabases::of_program().cluster();
  const auto ask = [this](auto question) {
    return std::async(std::launch::async, [question] {
      try {
        question();
        return std::string("it answered");
      } catch (const Failure& failure) {
        return std::string(failure.what());
      }
    });
  };
  cluster.freeze();
  std::future<std::string> reading =
      ask([this] { static_cast<void>(store_->list_arrivals("", "", 1)); });
  std::future<std::string> writing =
      ask([this] { store_->retire_reports(std::vector{attempt(1).report_uuid}); });
  EXPECT_EQ(reading.wait_for(std::chrono::milliseconds(100)), std::future_status::timeout);
  store_->stop_waiting();
  for (std::future<std::string>* const asked : {&reading, &writing}) {
    const std::string why = asked->get();
    EXPECT_NE(why.find("the server is stopping"), std::string::npos) << why;
  }
  const std::string later = ask([this] { static_cast<void>(store_->notes("")); }).get();
  EXPECT_NE(later.find("the server is stopping"), std::string::npos) << later;
  store_.reset();
  cluster.thaw();
  EXPECT_EQ(another()->status().attempts, 1U);
}

TEST_F(PostgresStoreTest, ADamagedPathIsSetAsideAndComesBackWithItsReport) {
  test::report(*store_, {attempt(1), attempt(2), attempt(3)});
  sql("UPDATE path SET waypoints = set_byte(waypoints, 50, get_byte(waypoints, 50) # 255)"
      " WHERE id = 2");
  const auto paths = store_->read_paths(robot_.digest, "shelf", {.limit = 2});
  ASSERT_EQ(paths.size(), 2U);  // a full page, without the damaged one
  EXPECT_EQ(paths[1].report_uuid, test::id_from<Uuid>(3));
  drain();
  drain();
  EXPECT_EQ(store_->status().paths, 2U);
  EXPECT_NE(store_->status().message.find("1 damaged path"), std::string::npos);
  EXPECT_EQ(store_->generation(robot_.digest, "shelf"), 2U);
  EXPECT_EQ(test::report(*store_, {attempt(2)}).at(0).status, ReceiptStatus::Stored);
  EXPECT_EQ(test::report(*store_, {attempt(2)}).at(0).status, ReceiptStatus::Duplicate);
  EXPECT_TRUE(store_->find_attempt(test::id_from<Uuid>(2))->path);
  EXPECT_EQ(store_->status().paths, 3U);
  EXPECT_EQ(store_->status().message, "");
}

TEST_F(PostgresStoreTest, WithoutAStandbyNothingIsAcknowledgedThatNeedsOne) {
  store_ = another({.require_synchronous = true});
  const Receipt receipt = test::report(*store_, {attempt(1)}).at(0);
  EXPECT_EQ(receipt.status, ReceiptStatus::TryAgain);
  EXPECT_NE(receipt.message.find("synchronous_standby_names"), std::string::npos)
      << receipt.message;
  EXPECT_FALSE(store_->status().writable);
  EXPECT_NE(store_->status().message.find("no synchronous standby"), std::string::npos);
  EXPECT_EQ(sql("SELECT count(*) FROM attempt"), "0");
  EXPECT_THROW(static_cast<void>(store_->register_robot(test::make_robot("iiwa", 2))), Failure);
}

TEST_F(PostgresStoreTest, TheAuditLogIsAppendOnly) {
  store_->add_audit({.client = "test", .verb = "reset", .target = "shelf"});
  for (const char* const change :
       {"UPDATE audit SET verb = 'x'", "DELETE FROM audit", "TRUNCATE audit"})
    EXPECT_THROW(sql(change), std::exception) << change;
  EXPECT_EQ(store_->list_audit("", "", 10).rows.size(), 1U);
}

TEST_F(PostgresStoreTest, RefusesWhatItDoesNotKnow) {
  const auto refusal = [&] {
    try {
      static_cast<void>(another());
    } catch (const Failure& failure) {
      return std::string(failure.what());
    }
    return std::string();
  };
  const std::size_t count = postgres::embedded_migrations().size();
  const std::string known = std::to_string(count), newer = std::to_string(count + 1);
  sql("INSERT INTO schema_migration VALUES (" + newer +
      ", 'x', decode(repeat('00', 32), 'hex'), 1, '15')");
  EXPECT_NE(refusal().find("it has schema " + newer + "; this binary knows up to " + known),
            std::string::npos)
      << refusal();
  sql("DELETE FROM schema_migration WHERE version = " + newer);
  sql("UPDATE schema_migration SET sha256 = decode(repeat('00', 32), 'hex')");
  EXPECT_NE(refusal().find("another text of migration 1"), std::string::npos) << refusal();
}

}  // namespace
}  // namespace kinship::store::postgres_store_test
