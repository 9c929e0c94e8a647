#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "server/store/postgres/postgres_store.hpp"
#include "tests/faults/report_history.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/postgres_query.hpp"
#include "tests/support/store_values.hpp"

/// What a receipt must wait for, one trap of PostgreSQL after the other. Each test has the naive
/// way beside it, where that loses what was acknowledged.
namespace kinship::test::postgres_receipt_test {
namespace {

constexpr const char* kDatabase = "fleet";
const std::string kSomebodyWaits =
    "SELECT EXISTS (SELECT FROM pg_stat_activity WHERE wait_event = 'SyncRep')";

class PostgresReceipt : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
  }
  void make_pair(const std::string& synchronous_standby_names) {
    primary_ = std::make_unique<PostgresCluster>(PostgresCluster::Options{
        .name = "a",
        .settings = {"synchronous_standby_names = '" + synchronous_standby_names + "'"}});
    primary_->create_database(kDatabase);
    standby_ = std::make_unique<PostgresCluster>(*primary_, PostgresCluster::Options{.name = "b"});
    url_ = url_of_either(*primary_, *standby_, kDatabase);
  }
  /// \param synchronous  whether it acknowledges nothing that no standby has.
  std::unique_ptr<store::Store> open(bool synchronous) const {
    std::unique_ptr<store::Store> store = store::open_postgres_store(
        url_, {.retry_after = std::chrono::milliseconds(50), .require_synchronous = synchronous});
    for (const store::RobotRecord& robot : history_robots())
      static_cast<void>(store->register_robot(robot));
    return store;
  }

  std::unique_ptr<PostgresCluster> primary_, standby_;
  std::string url_;
};

/// A report that is on its way, sent again as long as the store says TryAgain.
class PendingReport {
 public:
  PendingReport(store::Store& store, std::uint64_t number)
      : answer_(std::async(std::launch::async, [&store, number] {
          Receipt receipt = report(store, {numbered_report(number)}).at(0);
          while (receipt.status == ReceiptStatus::TryAgain) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            receipt = report(store, {numbered_report(number)}).at(0);
          }
          return receipt.status;
        })) {}

  bool is_answered() const {
    return answer_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }
  ReceiptStatus wait() { return answer_.get(); }

 private:
  std::future<ReceiptStatus> answer_;
};

/// As a server would that has not read the manual to its end.
bool reports_naively(const std::string& url, int number) {
  try {
    query_postgres(url, "SET synchronous_commit = on; INSERT INTO naive VALUES (" +
                            std::to_string(number) + ") ON CONFLICT DO NOTHING");
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

/// Ends each wait for a standby, by one of PostgreSQL's two functions. \return a time before that.
std::string end_waits(const PostgresCluster& cluster, const std::string& how) {
  const std::string before = cluster.query("SELECT clock_timestamp()");
  cluster.query("SELECT count(" + how +
                "(pid)) FROM pg_stat_activity WHERE wait_event = 'SyncRep'");
  return before;
}

TEST_F(PostgresReceipt, TheNaiveWayLosesWhatItHasAcknowledgedTwice) {
  make_pair("ANY 1 (a, b)");
  const std::string url = primary_->url(kDatabase);
  primary_->query("CREATE TABLE naive (number bigint PRIMARY KEY)", kDatabase);
  wait_until_replayed(*primary_, *standby_);
  standby_->freeze_receiver();

  std::future<bool> first = std::async(std::launch::async, [&] { return reports_naively(url, 1); });
  wait_until_true(url, kSomebodyWaits);
  end_waits(*primary_, "pg_cancel_backend");
  EXPECT_TRUE(first.get()) << "PostgreSQL warns, and says that it has committed";
  EXPECT_TRUE(reports_naively(url, 1)) << "who writes nothing waits for nobody";

  lose_primary(*primary_, *standby_);
  standby_->promote();
  EXPECT_EQ(standby_->query("SELECT count(*) FROM naive", kDatabase), "0");
}

TEST_F(PostgresReceipt, ACancelledWaitAndTheDuplicateAfterItAreNoReceipts) {
  make_pair("ANY 1 (a, b)");
  const std::string url = primary_->url(kDatabase);
  const std::unique_ptr<store::Store> one = open(true), other = open(true);
  ASSERT_EQ(report(*one, {numbered_report(0)}).at(0).status, ReceiptStatus::Stored);
  standby_->freeze_receiver();

  PendingReport sent(*one, 2);
  wait_until_true(url, kSomebodyWaits);
  PendingReport sent_again(*other, 2);
  for (const char* const how : {"pg_cancel_backend", "pg_terminate_backend"}) {
    const std::string before = end_waits(*primary_, how);
    wait_until_true(url,  // sent again, it waits again
                    "SELECT EXISTS (SELECT FROM pg_stat_activity WHERE wait_event = 'SyncRep'"
                    " AND query_start > '" +
                        before + "')");
    EXPECT_FALSE(sent.is_answered() || sent_again.is_answered()) << how;
  }

  lose_primary(*primary_, *standby_);
  standby_->promote();
  primary_->rewind_and_follow(*standby_);
  const std::vector<ReceiptStatus> answers = {sent.wait(), sent_again.wait()};
  EXPECT_EQ(std::count(answers.begin(), answers.end(), ReceiptStatus::Stored), 1);
  EXPECT_EQ(std::count(answers.begin(), answers.end(), ReceiptStatus::Duplicate), 1);
  EXPECT_TRUE(one->find_attempt(numbered_report(0).report_uuid));
  EXPECT_TRUE(one->find_attempt(numbered_report(2).report_uuid));
}

TEST_F(PostgresReceipt, ARetirementThatIsThereAlreadyIsNoAnswerBeforeItsStandbyHasIt) {
  make_pair("ANY 1 (a, b)");
  const std::string url = primary_->url(kDatabase);
  const std::unique_ptr<store::Store> one = open(true), other = open(true);
  wait_until_replayed(*primary_, *standby_);
  standby_->freeze_receiver();
  const std::vector<Uuid> reports = {numbered_report(7).report_uuid};  // that has not come yet
  const auto retire = [&reports](store::Store& store) {
    return std::async(std::launch::async, [&] {
      try {
        store.retire_reports(reports);
        return true;
      } catch (const Failure&) {
        return false;
      }
    });
  };
  std::future<bool> first = retire(*one);
  wait_until_true(url, kSomebodyWaits);
  end_waits(*primary_, "pg_cancel_backend");
  EXPECT_FALSE(first.get()) << "it is not certain";
  std::future<bool> second = retire(*other);
  wait_until_true(url, kSomebodyWaits);
  EXPECT_NE(second.wait_for(std::chrono::seconds(0)), std::future_status::ready);
  standby_->thaw_receiver();
  EXPECT_TRUE(second.get());
  lose_primary(*primary_, *standby_);
  standby_->promote();
  EXPECT_EQ(standby_->query("SELECT count(*) FROM retired_report", kDatabase), "1");
}

TEST_F(PostgresReceipt, WithoutItsStandbyNothingIsAcknowledgedUntilItIsBack) {
  make_pair("ANY 1 (a, b)");
  const std::unique_ptr<store::Store> store = open(true);
  ASSERT_EQ(report(*store, {numbered_report(0)}).at(0).status, ReceiptStatus::Stored);
  standby_->kill();
  PendingReport waiting(*store, 2);
  wait_until_true(primary_->url(), kSomebodyWaits);
  EXPECT_EQ(store->generation(numbered_report(0).robot, numbered_report(0).task), 1U);
  EXPECT_FALSE(waiting.is_answered());
  standby_->start();
  EXPECT_NE(waiting.wait(), ReceiptStatus::Refused);
  wait_until_replayed(*primary_, *standby_);
  lose_primary(*primary_, *standby_);
  standby_->promote();
  EXPECT_TRUE(store->find_attempt(numbered_report(2).report_uuid));
}

TEST_F(PostgresReceipt, ARobotIsKnownAlsoWhileNothingCanBeCommittedAndNewAgainOnceItIsLost) {
  make_pair("");
  const std::unique_ptr<store::Store> store = open(false);
  const store::RobotRecord robot = make_robot("newcomer", 77);
  wait_until_replayed(*primary_, *standby_);
  standby_->freeze_receiver();
  EXPECT_EQ(store->register_robot(robot).value_or_throw(), RegisterStatus::Registered);
  const std::unique_ptr<store::Store> strict = store::open_postgres_store(
      primary_->url(kDatabase), {.require_synchronous = true});  // of which there is none
  EXPECT_EQ(strict->register_robot(robot).value_or_throw(), RegisterStatus::Known);
  EXPECT_THROW(static_cast<void>(strict->register_robot(make_robot("other", 78))), Failure);
  lose_primary(*primary_, *standby_);
  standby_->promote();
  EXPECT_EQ(store->register_robot(robot).value_or_throw(), RegisterStatus::Registered);
}

TEST_F(PostgresReceipt, WhatComesAfterAFailoverIsToldToServersThatLookedBefore) {
  make_pair("");
  const std::unique_ptr<store::Store> one = open(false), other = open(false);
  wait_until_replayed(*primary_, *standby_);
  standby_->freeze_receiver();
  primary_->query(  // numbers of transactions that the standby never hears of, and gives anew
      "DO $$ BEGIN FOR i IN 1..100 LOOP PERFORM pg_current_xact_id(); COMMIT; END LOOP; END $$",
      kDatabase);
  const std::string cursor = other->changes_since("").value().cursor;
  lose_primary(*primary_, *standby_);
  standby_->promote();
  ASSERT_EQ(PendingReport(*one, 0).wait(), ReceiptStatus::Stored);
  const store::StoreChanges changes = other->changes_since(cursor).value();
  EXPECT_EQ(std::ranges::count(changes.experience, numbered_report(0).task,
                               &store::ChangedExperience::task),
            1);
}

/// What the ledger of the other tests would see if the engine did not wait.
TEST_F(PostgresReceipt, AnAsynchronousStandbyLosesReceiptsAndTheHistoryFindsThem) {
  make_pair("");
  const std::unique_ptr<store::Store> store = open(false);
  wait_until_replayed(*primary_, *standby_);
  standby_->freeze_receiver();
  std::vector<HistoryEntry> history;
  for (std::uint64_t number = 0; number < 20; ++number) {
    history.push_back({.kind = HistoryEntry::Kind::Begun, .number = number});
    history.push_back({.kind = HistoryEntry::Kind::Answered,
                       .number = number,
                       .status = static_cast<std::uint32_t>(
                           report(*store, {numbered_report(number)}).at(0).status),
                       .ended_ns = history_now_ns()});
  }
  EXPECT_EQ(find_faults(*store, history), HistoryFaults{});
  lose_primary(*primary_, *standby_);
  standby_->promote();
  const HistoryFaults faults = find_faults(*store::open_postgres_store(url_), history);
  EXPECT_EQ(faults.lost, 20U);
  EXPECT_EQ(faults.pathless, 16U);
}

}  // namespace
}  // namespace kinship::test::postgres_receipt_test
