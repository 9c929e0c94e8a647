#include "client/link/delivery.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <future>

#include "proto/types/limits.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::link::delivery_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// A server that stores everything it is sent once, unless told otherwise.
class Deliver : public testing::Test {
 protected:
  Result<std::vector<Receipt>> deliver(const std::vector<Attempt>& attempts,
                                       std::chrono::milliseconds timeout = 5s) {
    return link::deliver(attempts, timeout, sleep_,
                         [this](const ReportRequest& batch, Clock::time_point) {
                           batches_.push_back(batch.attempts.size());
                           return answer_(batch);
                         });
  }
  static Result<ReportReply> store(const ReportRequest& batch) {
    ReportReply reply;
    for (const Attempt& attempt : batch.attempts)
      reply.receipts.push_back({attempt.report_uuid, ReceiptStatus::Stored, ""});
    std::ranges::reverse(reply.receipts);  // their order is the server's business
    return reply;
  }
  std::vector<Attempt> attempts(std::size_t count) {
    std::vector<Attempt> made;
    while (made.size() < count) {
      made.push_back(values_.attempt());
      made.back().record.outcome = Outcome::Timeout;
      made.back().path.reset();
    }
    return made;
  }

  test::RandomValues values_{43};
  std::function<Result<ReportReply>(const ReportRequest&)> answer_ = store;
  std::vector<std::size_t> batches_;
  InterruptibleSleep sleep_;
};

TEST_F(Deliver, APauseOfAMinuteEndsWithWhoEndsIt) {
  std::promise<void> asked;
  answer_ = [&](const ReportRequest&) -> Result<ReportReply> {
    asked.set_value();  // once: it is not sent again
    ReportReply busy;
    busy.retry_after = 60s;
    return busy;
  };
  const auto begin = Clock::now();
  auto delivered = std::async(std::launch::async, [&] { return deliver(attempts(3), 30s); });
  asked.get_future().wait();
  sleep_.end();
  const auto receipts = delivered.get().value_or_throw();
  EXPECT_LT(Clock::now() - begin, 20s);
  ASSERT_EQ(receipts.size(), 3U);
  EXPECT_EQ(receipts[0].status, ReceiptStatus::TryAgain);
}

TEST_F(Deliver, ReceiptsComeInTheOrderOfTheAttempts) {
  const std::vector<Attempt> sent = attempts(20);
  const auto receipts = deliver(sent);
  ASSERT_TRUE(receipts);
  ASSERT_EQ(receipts->size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i)
    EXPECT_EQ((*receipts)[i].report_uuid, sent[i].report_uuid);
}

TEST_F(Deliver, APauseThatTheServerAsksForDoesNotCount) {
  std::vector<Clock::time_point> asked;
  answer_ = [&](const ReportRequest& batch) -> Result<ReportReply> {
    asked.push_back(Clock::now());
    if (asked.size() > 2)
      return store(batch);
    ReportReply busy;
    busy.retry_after = 400ms;
    return busy;
  };
  const auto receipts = deliver(attempts(3), 600ms).value_or_throw();
  ASSERT_EQ(asked.size(), 3U);
  EXPECT_GE(asked[1] - asked[0], 400ms);
  for (const Receipt& receipt : receipts)
    EXPECT_EQ(receipt.status, ReceiptStatus::Stored);
}

TEST_F(Deliver, BatchesKeepTheLimits) {
  ASSERT_TRUE(deliver(attempts(kMaxAttemptsPerBatch + 1)));
  EXPECT_EQ(batches_, (std::vector<std::size_t>{kMaxAttemptsPerBatch, 1}));
  batches_.clear();
  std::vector<Attempt> large = attempts(3);
  constexpr Eigen::Index kWaypoints = 10'000;  // 3 x 240 000 bytes
  for (Attempt& attempt : large) {
    attempt.record.outcome = Outcome::Solved;
    attempt.path = Path(Eigen::MatrixXd::Zero(3, kWaypoints));
  }
  ASSERT_TRUE(deliver(large));
  EXPECT_EQ(batches_, (std::vector<std::size_t>{2, 1}));
}

TEST_F(Deliver, WhatBreaksARuleIsRefusedHereAndNotSent) {
  std::vector<Attempt> sent = attempts(3);
  sent[1].task = "two words";
  const auto receipts = deliver(sent);
  ASSERT_TRUE(receipts);
  EXPECT_EQ((*receipts)[0].status, ReceiptStatus::Stored);
  EXPECT_EQ((*receipts)[1].status, ReceiptStatus::Refused);
  EXPECT_NE((*receipts)[1].message.find("task"), std::string::npos) << (*receipts)[1].message;
  EXPECT_EQ((*receipts)[2].status, ReceiptStatus::Stored);
  EXPECT_EQ(batches_, std::vector<std::size_t>{2});
}

TEST_F(Deliver, WhatCouldNotBeStoredYetIsSentAgainAlone) {
  answer_ = [this](const ReportRequest& batch) {
    Result<ReportReply> reply = store(batch);
    if (batches_.size() > 1)
      return reply;
    ReportReply first = *reply;
    first.receipts[0] = {batch.attempts.back().report_uuid, ReceiptStatus::TryAgain, "disk full"};
    return Result<ReportReply>(first);
  };
  const auto receipts = deliver(attempts(4));
  ASSERT_TRUE(receipts);
  EXPECT_EQ(batches_, (std::vector<std::size_t>{4, 1}));
  EXPECT_TRUE(std::ranges::all_of(
      *receipts, [](const Receipt& receipt) { return receipt.status == ReceiptStatus::Stored; }));
}

TEST_F(Deliver, OneReportTwiceHasTwoReceipts) {
  answer_ = [this](const ReportRequest& batch) {
    ReportReply reply = *store(batch);
    if (batches_.size() > 1)
      reply.receipts[0].status = ReceiptStatus::Duplicate;
    return Result<ReportReply>(reply);
  };
  std::vector<Attempt> sent = attempts(1);
  sent.push_back(sent.front());
  const auto receipts = deliver(sent);
  ASSERT_TRUE(receipts);
  EXPECT_EQ((*receipts)[0].status, ReceiptStatus::Stored);
  EXPECT_EQ((*receipts)[1].status, ReceiptStatus::Duplicate);
}

TEST_F(Deliver, WithoutAnAnswerThereAreNoReceipts) {
  answer_ = [](const ReportRequest&) {
    return Result<ReportReply>(Error{ErrorCode::Unavailable, "nobody"});
  };
  EXPECT_EQ(deliver(attempts(2)).error().code, ErrorCode::Unavailable);
}

TEST_F(Deliver, WhatHasNoReceiptInTimeIsToBeTriedAgain) {
  answer_ = [](const ReportRequest&) { return Result<ReportReply>(ReportReply{}); };
  const auto receipts = deliver(attempts(1), 300ms);
  ASSERT_TRUE(receipts);
  EXPECT_EQ(receipts->front().status, ReceiptStatus::TryAgain);
}

}  // namespace
}  // namespace kinship::link::delivery_test
