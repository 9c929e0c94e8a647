#include "client/link/report_sender.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <fstream>
#include <future>
#include <memory>
#include <mutex>
#include <thread>

#include "client/link/durable_file.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/store_epoch.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::link::report_sender_test {
namespace {

using namespace std::chrono_literals;
constexpr std::uint64_t kSeed = 36;

std::chrono::steady_clock::time_point in(std::chrono::milliseconds time) {
  return std::chrono::steady_clock::now() + time;
}

/// What a server answers that gives every attempt the same status.
ReportReply answer(const ReportRequest& batch, ReceiptStatus status,
                   const std::string& message = "", const Uuid& epoch = Uuid{}) {
  ReportReply reply{epoch, {}};
  for (const Attempt& attempt : batch.attempts)
    reply.receipts.push_back({attempt.report_uuid, status, message});
  return reply;
}

class ReportSenderTest : public testing::Test {
 protected:
  Attempt add() {
    Attempt attempt = values.attempt(5);
    outbox.add(attempt);
    return attempt;
  }
  std::filesystem::path rejected(const Uuid& uuid, const std::string& suffix) const {
    return folder.path() / "rejected" / (uuid.text() + suffix);
  }

  test::TemporaryDirectory folder;
  test::RandomValues values{kSeed};
  Outbox outbox{folder.path()};
};

TEST_F(ReportSenderTest, EverythingPendingIsSentInBatches) {
  for (int i = 0; i < 300; ++i)
    add();
  std::vector<std::size_t> sizes;
  ReportSender sender(outbox, [&](const ReportRequest& batch) {
    sizes.push_back(batch.attempts.size());
    return answer(batch, ReceiptStatus::Stored);
  });
  sender.wait_until_empty(in(20s));
  EXPECT_EQ(outbox.pending_count(), 0U);
  EXPECT_EQ(sender.counts().accepted, 300U);
  EXPECT_EQ(sizes, (std::vector<std::size_t>{256, 44}));
}

TEST_F(ReportSenderTest, ABusyServerIsAskedAgainWhenItSaysAndNothingIsLost) {
  add();
  std::vector<std::chrono::steady_clock::time_point> asked;
  ReportSender sender(outbox, [&](const ReportRequest& batch) {
    asked.push_back(std::chrono::steady_clock::now());
    if (asked.size() == 3)
      return answer(batch, ReceiptStatus::Stored);
    ReportReply busy;  // as of a server that did not even read the batch
    busy.retry_after = asked.size() == 1 ? 300ms : 1700ms;
    busy.message = "busy";
    return busy;
  });
  const auto give_up = in(20s);
  while (sender.counts().problem.empty() && std::chrono::steady_clock::now() < give_up)
    sender.wait_until_empty(in(1ms));
  EXPECT_EQ(sender.counts().problem, "busy");
  sender.wake();  // something new in the outbox is no reason to come earlier
  sender.wait_until_empty(in(20s));
  EXPECT_EQ(sender.counts().accepted, 1U);
  ASSERT_EQ(asked.size(), 3U);
  EXPECT_GE(asked[1] - asked[0], 300ms);
  EXPECT_LT(asked[1] - asked[0], 1000ms) << "the server's time, not the sender's own";
  EXPECT_GE(asked[2] - asked[1], 1700ms);
}

TEST_F(ReportSenderTest, BatchesKeepTheLimitOfBytes) {
  for (int i = 0; i < 5; ++i) {
    Attempt attempt = values.attempt();
    attempt.record.outcome = Outcome::Solved;
    attempt.path = Path(Eigen::MatrixXd::Zero(7, 4000));  // 224 000 bytes
    outbox.add(attempt);
  }
  std::vector<std::size_t> sizes;
  ReportSender sender(outbox, [&](const ReportRequest& batch) {
    sizes.push_back(batch.attempts.size());
    return answer(batch, ReceiptStatus::Stored);
  });
  sender.wait_until_empty(in(20s));
  EXPECT_EQ(sizes, (std::vector<std::size_t>{2, 2, 1}));
}

TEST_F(ReportSenderTest, WhatIsAddedLaterIsSentWhenWoken) {
  std::atomic<int> batches = 0;
  ReportSender sender(outbox, [&](const ReportRequest& batch) {
    ++batches;
    return answer(batch, ReceiptStatus::Recorded);
  });
  for (int i = 1; i <= 3; ++i) {
    add();
    sender.wake();
    sender.wait_until_empty(in(10s));
    EXPECT_EQ(outbox.pending_count(), 0U);
  }
  EXPECT_EQ(sender.counts().accepted, 3U);
}

TEST_F(ReportSenderTest, UnansweredAndTryAgainStayPendingUntilTheyAreStored) {
  add();
  std::atomic<int> calls = 0;
  ReportSender sender(outbox, [&](const ReportRequest& batch) -> Result<ReportReply> {
    switch (++calls) {
      case 1:
        return Error{ErrorCode::Unavailable, "no server"};
      case 2:
        return answer(batch, ReceiptStatus::TryAgain, "disk full");
      case 3:
        return ReportReply{};  // no receipt
      default:
        return answer(batch, ReceiptStatus::Duplicate);
    }
  });
  sender.wait_until_empty(in(20s));
  EXPECT_EQ(calls, 4);
  EXPECT_EQ(sender.counts().accepted, 1U);
  EXPECT_EQ(sender.counts().problem, "");
}

TEST_F(ReportSenderTest, ProblemIsTold) {
  add();
  std::promise<void> called_twice;
  std::atomic<int> calls = 0;
  ReportSender sender(outbox, [&](const ReportRequest&) -> Result<ReportReply> {
    if (++calls == 2)
      called_twice.set_value();
    return Error{ErrorCode::Unavailable, "no server"};
  });
  called_twice.get_future().wait();
  EXPECT_EQ(sender.counts().problem, "no server");
  EXPECT_EQ(outbox.pending_count(), 1U);
}

TEST_F(ReportSenderTest, RefusedAndDamagedReportsDoNotHoldUpOthers) {
  const Uuid refused = add().report_uuid;
  const Uuid stored = add().report_uuid;
  const Uuid damaged = Uuid::random();
  std::ofstream(folder.path() / "pending" / (damaged.text() + ".json")) << "{\"report_uuid\":";
  ReportSender sender(outbox, [&](const ReportRequest& batch) {
    ReportReply reply = answer(batch, ReceiptStatus::Stored);
    for (Receipt& receipt : reply.receipts)
      if (receipt.report_uuid == refused)
        receipt = {refused, ReceiptStatus::Refused, "robot 'ur5e': joint 3 at 3.31 rad"};
    return reply;
  });
  sender.wait_until_empty(in(10s));
  EXPECT_EQ(sender.counts().accepted, 1U);
  EXPECT_EQ(sender.counts().refused, 2U);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "sent" / (stored.text() + ".json")));
  EXPECT_EQ(read_file(rejected(refused, ".reason.txt"), 100),
            "robot 'ur5e': joint 3 at 3.31 rad\n");
  EXPECT_TRUE(std::filesystem::exists(rejected(damaged, ".json")));
}

TEST_F(ReportSenderTest, ReceiptsForOthersAreIgnored) {
  const Uuid mine = add().report_uuid;
  std::atomic<int> calls = 0;
  ReportSender sender(outbox, [&](const ReportRequest& batch) {
    if (++calls > 1)
      return answer(batch, ReceiptStatus::Stored);
    return ReportReply{Uuid{}, {{Uuid::random(), ReceiptStatus::Stored, ""}}};
  });
  sender.wait_until_empty(in(10s));
  EXPECT_EQ(calls, 2);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "sent" / (mine.text() + ".json")));
}

TEST_F(ReportSenderTest, SentReportsGrowOlderByTheTimeInWhichItRunsHourByHour) {
  const auto start = std::chrono::steady_clock::now();
  std::atomic<int> minutes = 0;
  const auto file = [&](const char* part, const Uuid& uuid) {
    return folder.path() / part / (uuid.text() + ".json");
  };
  Uuid first;
  for (const int days : {3, 4}) {  // two processes; the end of each counts
    minutes = 0;
    ReportSender sender(
        outbox, [](const ReportRequest& batch) { return answer(batch, ReceiptStatus::Stored); }, {},
        [&] { return start + std::chrono::minutes(minutes); });
    const Uuid uuid = add().report_uuid;
    sender.wake();
    sender.wait_until_empty(in(10s));
    if (days == 3)
      first = uuid;
    EXPECT_TRUE(std::filesystem::exists(file("sent", first))) << days;
    minutes = 60 * 24 * days;
  }
  EXPECT_TRUE(std::filesystem::exists(file("sent_before", first)));
}

/// A server that comes and goes, and whose store has an epoch.
class GreetingTest : public ReportSenderTest {
 protected:
  std::unique_ptr<ReportSender> make_sender() {
    return std::make_unique<ReportSender>(
        outbox,
        [this](const ReportRequest& batch) -> Result<ReportReply> {
          const std::lock_guard lock(mutex);
          batches.push_back(batch);
          changed.notify_all();
          if (is_silent)
            return Error{ErrorCode::Unavailable, "no answer"};
          ReportReply reply = answer(batch, ReceiptStatus::Stored, "", epoch);
          reply.consistency_token = token;
          return reply;
        },
        ReportSender::Register{}, [this] { return start + std::chrono::minutes(minutes); },
        [this] { return servers.load(); });
  }
  void wait_for_batches(std::size_t count) {
    std::unique_lock lock(mutex);
    EXPECT_TRUE(changed.wait_for(lock, 30s, [&] { return batches.size() >= count; }));
  }
  ReportRequest batch(std::size_t number) {
    const std::lock_guard lock(mutex);
    return batches.at(number);
  }
  template <typename Change>
  void change(Change change) {
    const std::lock_guard lock(mutex);
    change();
  }
  void send_one(ReportSender& sender) {
    add();
    sender.wake();
    sender.wait_until_empty(in(10s));
  }

  const std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  std::atomic<int> minutes = 0;
  std::atomic<std::uint64_t> servers = 1;
  std::mutex mutex;  // guards what follows
  std::condition_variable changed;
  std::vector<ReportRequest> batches;
  Uuid epoch = Uuid::random();
  ConsistencyToken token = {1, 2, 3};
  bool is_silent = false;
};

TEST_F(GreetingTest, IdleSenderTellsANewServerWhatItKnowsAndOffersAgainWhatWasLost) {
  const auto sender = make_sender();
  send_one(*sender);
  change([&] { epoch = next_epoch(epoch); });
  ++servers;
  wait_for_batches(3);
  EXPECT_TRUE(batch(0).known_token.empty());
  EXPECT_TRUE(batch(1).attempts.empty());
  EXPECT_EQ(batch(1).known_token, token);
  EXPECT_EQ(batch(2).attempts.size(), 1U);
  EXPECT_EQ(batch(2).attempts.at(0).report_uuid, batch(0).attempts.at(0).report_uuid);
}

TEST_F(GreetingTest, GreetingWithoutAnAnswerIsRepeatedAndTheMarkKept) {
  const auto sender = make_sender();
  send_one(*sender);
  change([&] { is_silent = true; });
  ++servers;
  wait_for_batches(3);
  change([&] { is_silent = false; });
  wait_for_batches(4);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_TRUE(batch(i).attempts.empty());
    EXPECT_EQ(batch(i).known_token, token);
  }
}

TEST_F(GreetingTest, KnownServerIsGreetedEveryTenMinutes) {
  const auto sender = make_sender();
  send_one(*sender);
  for (int i = 0; i < 3; ++i) {  // rounds without a probe: each sends its report
    minutes += 9;
    send_one(*sender);
  }
  change([&] {
    for (const ReportRequest& batch : batches)
      EXPECT_EQ(batch.attempts.size(), 1U);
  });
  minutes += 10;
  sender->wake();
  wait_for_batches(5);
  EXPECT_TRUE(batch(4).attempts.empty());
}

TEST_F(GreetingTest, WhoNeverHadAReceiptGreetsNobody) {
  const auto sender = make_sender();
  ++servers;
  std::this_thread::sleep_for(300ms);  // nothing happens, for which there is no event
  send_one(*sender);
  EXPECT_EQ(batch(0).attempts.size(), 1U);
}

TEST_F(ReportSenderTest, SecondSenderOfAnOutboxLeavesItToTheFirst) {
  std::atomic<int> calls_of_second = 0;
  std::promise<void> first_is_sending;
  std::promise<void> go_on;
  add();
  ReportSender first(outbox, [&](const ReportRequest& batch) {
    first_is_sending.set_value();
    go_on.get_future().wait();
    return answer(batch, ReceiptStatus::Stored);
  });
  first_is_sending.get_future().wait();
  {
    ReportSender second(outbox, [&](const ReportRequest& batch) {
      ++calls_of_second;
      return answer(batch, ReceiptStatus::Stored);
    });
    second.wait_until_empty(in(300ms));
    EXPECT_EQ(outbox.pending_count(), 1U);
    go_on.set_value();
    second.wait_until_empty(in(10s));
  }
  EXPECT_EQ(outbox.pending_count(), 0U);
  EXPECT_EQ(calls_of_second, 0);
}

}  // namespace
}  // namespace kinship::link::report_sender_test
