#include <gtest/gtest.h>

#include <atomic>
#include <set>

#include "client/link/durable_file.hpp"
#include "client/link/report_sender.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::link::set_aside_test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr std::int64_t kHour_ms = 3'600'000;

/// A server whose database does not take some reports, though it takes all others.
class SetAside : public testing::Test {
 protected:
  Uuid add() {
    const Attempt attempt = values_.attempt(5);
    outbox_.add(attempt);
    return attempt.report_uuid;
  }
  ReportReply answer(const ReportRequest& batch) {
    ReportReply reply;
    for (const Attempt& attempt : batch.attempts) {
      const bool is_poison = takes_nothing_ || poison_.contains(attempt.report_uuid);
      reply.receipts.push_back({attempt.report_uuid,
                                is_poison ? ReceiptStatus::TryAgain : ReceiptStatus::Stored,
                                is_poison ? "violates check [23514]" : ""});
    }
    if (is_busy_)
      reply.retry_after = 1ms;
    ++batches_;
    return reply;
  }
  std::unique_ptr<ReportSender> start() {
    return std::make_unique<ReportSender>(
        outbox_, [this](const ReportRequest& batch) { return answer(batch); },
        ReportSender::Register(), std::chrono::steady_clock::now, ReportSender::CountServers(),
        SetAsideRule{.tries = 3, .age = 2h, .unix_ms = [this] { return unix_ms_.load(); }});
  }
  /// Another report is taken, an hour later.
  void take_one(ReportSender& sender) {
    const std::size_t accepted = sender.counts().accepted;
    unix_ms_ += kHour_ms;
    add();
    while (sender.counts().accepted == accepted)
      sender.retry();
  }
  fs::path file(const char* part, const Uuid& report, const char* suffix = ".json") const {
    return folder_.path() / part / (report.text() + suffix);
  }

  test::TemporaryDirectory folder_;
  test::RandomValues values_{38};
  Outbox outbox_{folder_.path()};
  std::set<Uuid> poison_;
  std::atomic<bool> takes_nothing_ = false, is_busy_ = false;
  std::atomic<int> batches_ = 0;
  std::atomic<std::int64_t> unix_ms_ = 1;
};

TEST_F(SetAside, APoisonReportIsKeptApartWithItsReasonAndOfferedAgainOnRequest) {
  const Uuid poison = *poison_.insert(add()).first;
  {
    const auto sender = start();
    take_one(*sender);
    take_one(*sender);
    EXPECT_EQ(sender->counts().set_aside, 0U);
    take_one(*sender);
    while (sender->counts().set_aside == 0)
      std::this_thread::yield();
    EXPECT_EQ(sender->counts().refused, 0U);
    EXPECT_NE(sender->counts().problem.find(poison.text()), std::string::npos);
  }
  EXPECT_TRUE(fs::exists(file("set_aside", poison)));
  EXPECT_EQ(outbox_.pending_count(), 0U);
  const std::vector<OutboxEntry> entries = outbox_.entries();
  ASSERT_EQ(entries.size(), 1U);
  EXPECT_EQ(entries[0].state, "set aside");
  EXPECT_NE(entries[0].why.find("3 times in 2 h"), std::string::npos) << entries[0].why;
  EXPECT_NE(entries[0].why.find("[23514]"), std::string::npos);
  poison_.clear();  // the administrator mends the database
  ASSERT_EQ(outbox_.reports_set_aside(), std::vector{poison});
  EXPECT_TRUE(outbox_.resend(poison));
  EXPECT_FALSE(outbox_.resend(poison));
  const auto sender = start();
  sender->wait_until_empty(std::chrono::steady_clock::now() + 30s);
  EXPECT_EQ(sender->counts().accepted, 1U);
  EXPECT_TRUE(outbox_.entries().empty());
}

TEST_F(SetAside, TriesOfShortProcessesAddUp) {
  const Uuid poison = *poison_.insert(add()).first;
  for (int process = 1; process <= 3; ++process) {
    EXPECT_TRUE(fs::exists(file("pending", poison))) << process;
    take_one(*start());
  }
  EXPECT_TRUE(fs::exists(file("set_aside", poison)));
}

TEST_F(SetAside, AServerThatTakesNothingForAYearIsNoReason) {
  const Uuid report = add();
  takes_nothing_ = true;
  const auto sender = start();
  while (batches_ < 20) {
    unix_ms_ += 24 * 365 * kHour_ms / 20;
    sender->retry();
  }
  ASSERT_EQ(sender->counts().set_aside, 0U);
  ASSERT_TRUE(fs::exists(file("pending", report)));
  takes_nothing_ = false;
  while (sender->counts().accepted == 0)
    sender->retry();
}

TEST_F(SetAside, AReportThatABusyServerPutsOffIsNoPoison) {
  const Uuid report = *poison_.insert(add()).first;
  is_busy_ = true;
  const auto sender = start();
  for (int tries = 0; tries < 6; ++tries)
    take_one(*sender);
  EXPECT_EQ(sender->counts().set_aside, 0U);
  EXPECT_TRUE(fs::exists(file("pending", report)));
}

TEST_F(SetAside, AClockThatJumpsMakesNoReportOld) {
  constexpr std::int64_t kYears_ms = 100 * 24 * 365 * kHour_ms;
  const Uuid poison = *poison_.insert(add()).first;
  const auto sender = start();
  take_one(*sender);
  for (const std::int64_t jump : {kYears_ms, -kYears_ms, -kYears_ms}) {
    unix_ms_ += jump - kHour_ms;  // take_one() adds the hour
    take_one(*sender);
  }
  EXPECT_EQ(sender->counts().set_aside, 0U) << "four tries, one hour";
  take_one(*sender);
  while (sender->counts().set_aside == 0)
    std::this_thread::yield();
  EXPECT_TRUE(fs::exists(file("set_aside", poison)));
}

TEST_F(SetAside, NothingWaitsBehindABatchOfPoison) {
  for (int i = 0; i < 300; ++i)
    poison_.insert(add());
  const Uuid good = add();
  const auto sender = start();
  while (sender->counts().accepted == 0)
    sender->retry();
  EXPECT_TRUE(fs::exists(file("sent", good)));
}

TEST_F(SetAside, NothingWaitsBehindABatchOfPoisonOnceAllWerePutOff) {
  for (int i = 0; i < 300; ++i)
    poison_.insert(add());
  for (int i = 0; i < 300; ++i)
    add();
  takes_nothing_ = true;
  const auto sender = start();
  while (batches_ < 3)  // of 256: all
    sender->retry();
  takes_nothing_ = false;
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (sender->counts().accepted < 300 && std::chrono::steady_clock::now() < deadline)
    sender->retry();
  EXPECT_EQ(sender->counts().accepted, 300U);
}

}  // namespace
}  // namespace kinship::link::set_aside_test
