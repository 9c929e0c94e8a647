// Reports of robots that the server does not know: they are never lost.

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <set>

#include "client/link/report_sender.hpp"
#include "proto/types/store_epoch.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::link::unknown_robot_test {
namespace {

using namespace std::chrono_literals;
constexpr std::uint64_t kSeed = 39;

/// What a server does with reports, without the network.
class Store {
 public:
  ReportReply report(const ReportRequest& batch) {
    const std::lock_guard lock(mutex_);
    ReportReply reply{epoch_, {}};
    for (const Attempt& attempt : batch.attempts) {
      const bool is_known = robots_.contains(attempt.robot);
      if (is_known)
        reports_.insert(attempt.report_uuid);
      reply.receipts.push_back(
          {attempt.report_uuid, is_known ? ReceiptStatus::Stored : ReceiptStatus::UnknownRobot,
           is_known ? "" : "robot " + attempt.robot.short_hex() + " is not known here"});
    }
    ++batches_;
    changed_.notify_all();
    return reply;
  }
  void add_robot(const Digest& robot) {
    const std::lock_guard lock(mutex_);
    robots_.insert(robot);
  }
  /// As from a backup of before there was anything in it.
  void restore() {
    const std::lock_guard lock(mutex_);
    robots_.clear();
    reports_.clear();
    epoch_ = next_epoch(epoch_);
  }
  void wait_for_batches(int count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return batches_ >= count; });
  }
  void wait_for_reports(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return reports_.size() >= count; });
  }

 private:
  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  Uuid epoch_ = Uuid::random();
  std::set<Digest> robots_;
  std::set<Uuid> reports_;
  int batches_ = 0;
};

class UnknownRobot : public testing::Test {
 protected:
  void add(const Digest& of) {
    Attempt attempt = values.attempt(5);
    attempt.robot = of;
    outbox.add(attempt);
  }
  ReportSender::Send send() {
    return [this](const ReportRequest& batch) { return store.report(batch); };
  }
  /// Registers `digest`, whatever its description says.
  ReportSender::Register registers(const Digest& digest) {
    return [this, digest](const RobotDescription&) {
      store.add_robot(digest);
      return RegisterReply{RegisterStatus::Registered, digest, 7, "", ""};
    };
  }
  std::size_t rejected() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder.path() / "rejected"), {}));
  }
  static std::chrono::steady_clock::time_point in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
  }

  test::TemporaryDirectory folder;
  test::RandomValues values{kSeed};
  Outbox outbox{folder.path()};
  Store store;
  const Digest robot = values.digest();
};

TEST_F(UnknownRobot, IsRegisteredFromItsKeptDescriptionAndItsReportsAreStored) {
  outbox.keep_robot(robot, values.robot_description());
  for (int i = 0; i < 3; ++i)
    add(robot);
  ReportSender sender(outbox, send(), registers(robot));
  sender.wait_until_empty(in(20s));
  EXPECT_EQ(outbox.pending_count(), 0U);
  EXPECT_EQ(sender.counts().accepted, 3U);
  EXPECT_EQ(sender.counts().problem, "");
  EXPECT_EQ(rejected(), 0U);
}

TEST_F(UnknownRobot, WithoutADescriptionItsReportsStayAndDoNotHoldUpOthers) {
  for (int i = 0; i < 260; ++i)  // more than a batch
    add(robot);
  const Digest known = values.digest();
  store.add_robot(known);
  add(known);
  ReportSender sender(outbox, send(), registers(robot));
  store.wait_for_reports(1);
  store.wait_for_batches(3);
  EXPECT_EQ(outbox.pending_count(), 260U);
  EXPECT_EQ(rejected(), 0U);
  EXPECT_NE(sender.counts().problem.find(robot.short_hex()), std::string::npos);
}

TEST_F(UnknownRobot, WhoseRegistrationIsRefusedHasItsReportsRejectedUntilTheyAreOfferedAgain) {
  RobotDescription description = values.robot_description();
  description.label = "ur5e_3";
  outbox.keep_robot(robot, description);
  for (int i = 0; i < 260; ++i)  // more than a batch
    add(robot);
  const Digest known = values.digest();
  store.add_robot(known);
  add(known);
  {
    ReportSender sender(outbox, send(), [](const RobotDescription&) {
      return RegisterReply{RegisterStatus::Refused, {}, 0, "", "'arm_7' may not register it"};
    });
    sender.wait_until_empty(in(20s));
    EXPECT_EQ(outbox.pending_count(), 0U);
    EXPECT_EQ(sender.counts().refused, 260U);
    EXPECT_EQ(sender.counts().accepted, 1U);
    EXPECT_NE(sender.counts().last_refusal.find("'arm_7' may not"), std::string::npos)
        << sender.counts().last_refusal;
  }
  const std::vector<Uuid> refused = outbox.reports_rejected();
  ASSERT_EQ(refused.size(), 260U);
  EXPECT_TRUE(outbox.drop(refused[0]));
  EXPECT_FALSE(outbox.drop(refused[0]));
  EXPECT_FALSE(outbox.resend(refused[0]));
  for (const Uuid& uuid : outbox.reports_rejected())
    EXPECT_TRUE(outbox.resend(uuid));
  EXPECT_EQ(rejected(), 0U) << "reasons go with their reports";
  ReportSender admitted(outbox, send(), registers(robot));
  admitted.wait_until_empty(in(20s));
  EXPECT_EQ(admitted.counts().accepted, 259U);
}

TEST_F(UnknownRobot, WhoseRegistrationIsRefusedForNowKeepsItsReports) {
  outbox.keep_robot(robot, values.robot_description());
  add(robot);
  ReportSender sender(outbox, send(), [](const RobotDescription&) {
    RegisterReply busy;
    busy.message = "busy";
    busy.retry_after = RetryAfter(100);
    return busy;
  });
  store.wait_for_batches(2);
  EXPECT_EQ(outbox.pending_count(), 1U);
  EXPECT_EQ(rejected(), 0U);
  EXPECT_FALSE(sender.counts().problem.empty());
}

TEST_F(UnknownRobot, StoreRestoredFromBeforeTheRegistrationGetsEverythingAgain) {
  outbox.keep_robot(robot, values.robot_description());
  add(robot);
  ReportSender sender(outbox, send(), registers(robot));
  sender.wait_until_empty(in(20s));
  store.restore();
  add(robot);
  sender.wake();
  store.wait_for_reports(2);
  sender.wait_until_empty(in(20s));
  EXPECT_EQ(outbox.pending_count(), 0U);
  EXPECT_EQ(rejected(), 0U);
}

}  // namespace
}  // namespace kinship::link::unknown_robot_test
