#include "server/service/ingest.hpp"

#include <gtest/gtest.h>

#include <future>
#include <mutex>
#include <string>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/fleet.hpp"
#include "tests/unit/server/troubled_store.hpp"

namespace kinship::service::ingest_test {
namespace {

class IngestTest : public testing::Test {
 protected:
  IngestTest() { registry_.register_robot(fleet::teacher(), 1); }

  std::future<std::vector<Receipt>> submit(std::vector<Attempt> attempts) {
    const auto promise = std::make_shared<std::promise<std::vector<Receipt>>>();
    ingest_.submit(std::move(attempts), [promise](const std::vector<Receipt>& receipts,
                                                  RetryAfter) { promise->set_value(receipts); });
    return promise->get_future();
  }
  static std::vector<ReceiptStatus> statuses(const std::vector<Receipt>& receipts) {
    std::vector<ReceiptStatus> found;
    found.reserve(receipts.size());
    for (const Receipt& receipt : receipts)
      found.push_back(receipt.status);
    return found;
  }

  test::TemporaryDirectory directory_;
  std::unique_ptr<store::Store> store_ = store::open_sqlite_store(directory_ / "fleet.db");
  runtime::RobotRegistry registry_{*store_};
  runtime::WorkerPool short_task_pool_{{.threads = 1, .queue_limit = 8, .niceness = 0}};
  std::mutex mutex_;
  std::vector<std::string> grown_;  // guarded by mutex_
  Ingest ingest_{*store_,
                 registry_,
                 short_task_pool_,
                 {.max_attempts = 16, .on_new_experience = [this](std::string_view task) {
                    const std::lock_guard lock(mutex_);
                    grown_.emplace_back(task);
                  }}};
  const runtime::Robot robot_ = fleet::robot_of(fleet::teacher());
};

TEST_F(IngestTest, AnswersABatchOnceInItsOrder) {
  Attempt unknown = fleet::solved(robot_, "shelf", 1);
  unknown.robot.bytes[0] ^= 1U;
  Attempt bad = fleet::solved(robot_, "shelf", 2);
  bad.path = fleet::path(4, 2);
  const std::vector<Attempt> batch = {bad, fleet::solved(robot_, "shelf", 3), unknown,
                                      fleet::unsolved(robot_.digest, "shelf")};
  const std::vector<Receipt> receipts = submit(batch).get();
  EXPECT_EQ(statuses(receipts),
            (std::vector{ReceiptStatus::Refused, ReceiptStatus::Stored, ReceiptStatus::UnknownRobot,
                         ReceiptStatus::Recorded}));
  for (std::size_t i = 0; i < batch.size(); ++i)
    EXPECT_EQ(receipts[i].report_uuid, batch[i].report_uuid);
  EXPECT_NE(receipts[0].message.find("a path of 4 joints"), std::string::npos)
      << receipts[0].message;
  EXPECT_EQ(receipts[2].message,
            "robot " + unknown.robot.short_hex() + " is not known here; register it first");
  EXPECT_EQ(ingest_.received(), 4U);
  EXPECT_EQ(ingest_.refused(), 1U);
}

TEST_F(IngestTest, RefusedAttemptsLeaveNothingBehind) {
  Attempt bad = fleet::solved(robot_, "shelf", 1);
  bad.path = fleet::path(4, 1);
  ASSERT_EQ(submit({bad}).get()[0].status, ReceiptStatus::Refused);
  EXPECT_FALSE(store_->find_attempt(bad.report_uuid));
  EXPECT_EQ(store_->status().attempts, 0U);
}

TEST_F(IngestTest, TellsOfTasksThatHaveANewPathAndOfNoOthers) {
  const Attempt path = fleet::solved(robot_, "shelf", 1);
  submit({path, fleet::solved(robot_, "shelf", 2), fleet::unsolved(robot_.digest, "bin")}).get();
  submit({path}).get();
  const std::lock_guard lock(mutex_);
  EXPECT_EQ(grown_, std::vector<std::string>{"shelf"});
}

TEST_F(IngestTest, MoreThanItMayHoldIsAskedToTryAgain) {
  const std::vector<Receipt> receipts = submit(fleet::solved(robot_, "shelf", 17, 1)).get();
  EXPECT_EQ(receipts.size(), 17U);
  for (const Receipt& receipt : receipts)
    EXPECT_EQ(receipt.status, ReceiptStatus::TryAgain);
  EXPECT_EQ(store_->status().attempts, 0U);
  EXPECT_EQ(submit(fleet::solved(robot_, "shelf", 16, 1)).get()[0].status, ReceiptStatus::Stored);
}

TEST_F(IngestTest, OneClientMayHaveSoManyOnTheirWay) {
  std::vector<std::string> told;
  Ingest ingest(
      *store_, registry_, short_task_pool_,
      {.client_attempts = 4, .on_over_quota = [&](const std::string&, const std::string& message) {
         told.push_back(message);
       }});
  const auto send = [&](int count, const std::string& client) {
    const auto done = std::make_shared<std::promise<Receipt>>();
    std::future<Receipt> receipt = done->get_future();
    ingest.submit(
        fleet::solved(robot_, "shelf", count, 100 * static_cast<std::uint64_t>(count)),
        [done](const std::vector<Receipt>& receipts, RetryAfter) { done->set_value(receipts[0]); },
        client);
    return receipt.get();
  };
  const Receipt receipt = send(5, "greedy");
  EXPECT_EQ(receipt.status, ReceiptStatus::TryAgain);
  EXPECT_EQ(receipt.message,
            "this client has 0 attempts on their way already; one client may have 4 of 16 MB "
            "together");
  EXPECT_EQ(told, std::vector{receipt.message});
  for (int i = 0; i < 3; ++i)  // what is answered counts no more
    EXPECT_EQ(send(4 - i, "greedy").status, ReceiptStatus::Stored);
  EXPECT_EQ(send(6, "").status, ReceiptStatus::Stored) << "nobody's have no quota";
}

TEST_F(IngestTest, ReadsRobotsOfTheStoreOnTheDesk) {
  runtime::RobotRegistry cold(*store_);
  Ingest ingest(*store_, cold, short_task_pool_, {});
  std::promise<std::vector<Receipt>> done;
  ingest.submit({fleet::solved(robot_, "shelf", 1)}, [&](const std::vector<Receipt>& receipts,
                                                         RetryAfter) { done.set_value(receipts); });
  EXPECT_EQ(done.get_future().get()[0].status, ReceiptStatus::Stored);
  ingest.drain();
}

TEST_F(IngestTest, ABusyDeskIsAReasonToTryAgain) {
  short_task_pool_.stop(runtime::WorkerPool::Leftovers::Run);
  Attempt unknown = fleet::solved(robot_, "shelf", 1);
  unknown.robot.bytes[0] ^= 1U;
  const std::vector<Receipt> receipts = submit({unknown}).get();
  EXPECT_EQ(receipts[0].status, ReceiptStatus::TryAgain);
  EXPECT_EQ(receipts[0].message, "the server is busy");
}

TEST_F(IngestTest, DrainingAnswersWhatWasTakenInAndTakesInNothingMore) {
  std::vector<std::future<std::vector<Receipt>>> answers;
  for (std::uint64_t i = 0; i < 10; ++i)
    answers.push_back(submit({fleet::solved(robot_, "shelf", i)}));
  ingest_.drain();
  EXPECT_EQ(ingest_.queued(), 0U);
  for (auto& answer : answers) {
    ASSERT_EQ(answer.wait_for(std::chrono::seconds(0)), std::future_status::ready);
    EXPECT_EQ(answer.get()[0].status, ReceiptStatus::Stored);
  }
  EXPECT_EQ(submit({fleet::solved(robot_, "shelf", 99)}).get()[0].status, ReceiptStatus::TryAgain);
}

TEST_F(IngestTest, AnEmptyBatchIsAnsweredToo) { EXPECT_TRUE(submit({}).get().empty()); }

TEST_F(IngestTest, ADamagedRobotCostsItsOwnAttemptsOnly) {
  const runtime::Robot pupil = fleet::robot_of(fleet::pupil());
  runtime::RobotRegistry(*store_).register_robot(fleet::pupil(),
                                                 2);  // not in the memory of the other one
  store::damage_robot(directory_ / "fleet.db", "pupil");
  const std::vector<Receipt> receipts =
      submit({fleet::solved(pupil, "shelf", 1), fleet::solved(robot_, "shelf", 2)}).get();
  EXPECT_EQ(statuses(receipts), (std::vector{ReceiptStatus::TryAgain, ReceiptStatus::Stored}));
  EXPECT_NE(receipts[0].message, "");
}

TEST_F(IngestTest, WhatTheStoreCannotTakeIsAskedForAgainAndDrainingEnds) {
  store::TroubledStore troubled(*store_);
  Ingest ingest(troubled, registry_, short_task_pool_, {});
  std::vector<Receipt> receipts;
  ingest.submit({fleet::solved(robot_, "shelf", 1), fleet::unsolved(robot_.digest, "shelf")},
                [&](const std::vector<Receipt>& answer, RetryAfter) { receipts = answer; });
  EXPECT_EQ(statuses(receipts), (std::vector{ReceiptStatus::TryAgain, ReceiptStatus::TryAgain}));
  EXPECT_EQ(ingest.queued(), 0U);
  ingest.drain();
}

}  // namespace
}  // namespace kinship::service::ingest_test
