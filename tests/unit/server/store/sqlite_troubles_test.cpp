// What SQLite refuses of reports that break no rule: they wait, and nothing waits with them.

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>

#include "proto/types/hex.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/next_schema.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::sqlite_troubles_test {
namespace {

using namespace std::chrono_literals;

class SqliteTroubles : public testing::Test {
 protected:
  SqliteTroubles() { EXPECT_TRUE(store_->register_robot(robot_)); }

  std::unique_ptr<Store> open(std::chrono::milliseconds put_off_for) const {
    return open_sqlite_store(file_, {.retry_after = 1ms, .put_off_for = put_off_for});
  }
  Attempt attempt(std::uint64_t number) const {
    return test::make_attempt(robot_.digest, "shelf", number);
  }
  void sql(const std::string& text) const { Database(file_, Access::ReadWrite).execute(text); }
  /// An administrator's trigger, for one report.
  void object(const std::string& how) const {
    sql("CREATE TRIGGER object BEFORE INSERT ON attempt WHEN NEW.report_uuid = x'" +
        to_hex(poison_.report_uuid.bytes) + "' BEGIN " + how + "; END");
  }
  void expect_that_all_are_taken(const std::vector<Attempt>& attempts) {
    for (const Receipt& receipt : test::report(*store_, attempts))
      EXPECT_TRUE(receipt.status == ReceiptStatus::Stored ||
                  receipt.status == ReceiptStatus::Duplicate)
          << receipt.message;
  }

  const test::TemporaryDirectory folder_;
  const std::filesystem::path file_ = folder_ / "store.db";
  const RobotRecord robot_ = test::make_robot("panda", 1);
  const Attempt poison_ = attempt(2);
  const std::vector<Attempt> three_ = {attempt(1), poison_, attempt(3)};
  std::unique_ptr<Store> store_ = open(0ms);
};

/// A trigger undoes the statement, leaves it half done, or undoes the whole transaction.
class EachTrigger : public SqliteTroubles, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Raises, EachTrigger, testing::Values("ABORT", "FAIL", "ROLLBACK"),
                         [](const auto& each) { return each.param; });

TEST_P(EachTrigger, PutsOffTheReportThatItHitsAlone) {
  store_.reset();
  store_ = open(PutOffReports::kRemembered);
  object("SELECT RAISE(" + std::string(GetParam()) + ", 'the administrator objects')");
  const std::vector<Receipt> receipts = test::report(*store_, three_);
  EXPECT_EQ(receipts[0].status, ReceiptStatus::Stored) << receipts[0].message;
  EXPECT_EQ(receipts[1].status, ReceiptStatus::TryAgain);
  EXPECT_NE(receipts[1].message.find("the administrator objects"), std::string::npos)
      << receipts[1].message;
  EXPECT_EQ(receipts[2].status, ReceiptStatus::Stored) << receipts[2].message;
  const StoreStatus status = store_->status();
  EXPECT_TRUE(status.writable) << "it takes others";
  EXPECT_NE(status.message.find("put off 1 time since the start"), std::string::npos)
      << status.message;
  EXPECT_NE(status.message.find("the administrator objects"), std::string::npos);
  sql("DROP TRIGGER object");
  store_.reset();
  store_ = open(0ms);
  expect_that_all_are_taken(three_);
  EXPECT_EQ(store_->status().attempts, 3U);
}

TEST_F(SqliteTroubles, WhatATriggerTakesAwayHasNoReceipt) {
  object("SELECT RAISE(IGNORE)");
  EXPECT_EQ(test::report(*store_, three_)[1].status, ReceiptStatus::TryAgain);
  EXPECT_EQ(store_->status().attempts, 2U);
  sql("DROP TRIGGER object");
  expect_that_all_are_taken(three_);
  EXPECT_EQ(store_->status().attempts, 3U);
}

TEST_F(SqliteTroubles, AUniqueIndexIsNoFaultOfReports) {
  sql("CREATE UNIQUE INDEX hand ON attempt (planner)");
  const std::vector<Receipt> receipts = test::report(*store_, three_);
  EXPECT_EQ(receipts[0].status, ReceiptStatus::Stored);
  for (const std::size_t other : {1U, 2U}) {
    EXPECT_EQ(receipts[other].status, ReceiptStatus::TryAgain);
    EXPECT_NE(receipts[other].message.find("UNIQUE constraint failed"), std::string::npos);
  }
  EXPECT_NE(store_->status().message.find("put off 2 times"), std::string::npos);
  sql("DROP INDEX hand");
  expect_that_all_are_taken(three_);
}

TEST_F(SqliteTroubles, AReportWithoutMemoryWaits) {
  const sqlite3_int64 before = sqlite3_hard_heap_limit64(1);
  const Receipt receipt = test::report(*store_, {attempt(1)}).at(0);
  sqlite3_hard_heap_limit64(before);
  EXPECT_EQ(receipt.status, ReceiptStatus::TryAgain);
  EXPECT_NE(receipt.message.find("out of memory"), std::string::npos) << receipt.message;
  constexpr int kTries = 10'000;
  ReceiptStatus again = ReceiptStatus::TryAgain;
  for (int i = 0; i < kTries && again == ReceiptStatus::TryAgain; ++i)
    again = test::report(*store_, {attempt(1)}).at(0).status;
  EXPECT_EQ(again, ReceiptStatus::Stored);
}

TEST_F(SqliteTroubles, ANewerSchemaEndsEveryWrite) {
  test::report(*store_, {attempt(1)});
  open_migrated(file_, test::with_next_schema(), Keep::Nothing);
  const Receipt receipt = test::report(*store_, {attempt(2)}).at(0);
  EXPECT_EQ(receipt.status, ReceiptStatus::TryAgain);
  EXPECT_THROW(static_cast<void>(store_->register_robot(test::make_robot("iiwa", 2))), Failure);
  EXPECT_THROW(static_cast<void>(store_->reset_task("shelf")), Failure);
  const StoreStatus status = store_->status();
  EXPECT_FALSE(status.writable);
  EXPECT_NE(status.message.find("this binary knows up to"), std::string::npos) << status.message;
  EXPECT_EQ(status.message.find("failures of the disk"), std::string::npos) << status.message;
  EXPECT_EQ(status.attempts, 1U);
  EXPECT_EQ(status.robots, 1U);
}

}  // namespace
}  // namespace kinship::store::sqlite_troubles_test
