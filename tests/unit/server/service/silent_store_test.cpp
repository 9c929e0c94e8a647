// A store of several servers that does not answer: who asks for what is in memory does not wait for
// it, also behind those who asked it for something.

#include <gtest/gtest.h>

#include <condition_variable>
#include <future>
#include <mutex>

#include "tests/unit/server/service/catalog_fixture.hpp"

namespace kinship::service::silent_store_test {
namespace {

constexpr std::chrono::seconds kEnough{60};

/// Where questions hang until it is let go of.
class Hang {
 public:
  void hold() {
    std::unique_lock lock(mutex_);
    is_asked_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return is_over_; });
  }
  bool wait_until_asked() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kEnough, [this] { return is_asked_; });
  }
  void let_go() {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_asked_ = false, is_over_ = false;
};

class SilentStore : public CatalogTest {
 protected:
  SilentStore() {
    may_trouble_store_ = true;
    adjust_ = [](ServiceOptions& options) {
      options.store_patience = std::chrono::milliseconds(50);
    };
    start();
    troubled_->has_others = true;
    teach(6);
  }
  void TearDown() override {
    hang_.let_go();
    CatalogTest::TearDown();
  }
  /// A first fetch is answered, and then the sums of attempts are read, which does not end.
  void hold_short_tasks() {
    troubled_->on_totals = [this] { hang_.hold(); };
    ASSERT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Ready);
    ASSERT_TRUE(hang_.wait_until_asked());
  }
  std::future<RegisterReply> begin_registration(const RobotDescription& robot) {
    const auto reply = std::make_shared<std::promise<RegisterReply>>();
    service_->registration().register_robot(
        robot, [reply](const RegisterReply& r) { reply->set_value(r); });
    return reply->get_future();
  }
  std::future<AdminPage> begin_asking(AdminVerb verb) {
    const auto page = std::make_shared<std::promise<AdminPage>>();
    service_->administration().administer(
        fleet::question(verb), "", [page](const AdminPage& p) { page->set_value(p); },
        fleet::caller_here());
    return page->get_future();
  }
  template <typename Reply>
  static bool comes(const std::future<Reply>& reply) {
    return reply.wait_for(kEnough) == std::future_status::ready;
  }

  Hang hang_;
};

TEST_F(SilentStore, AKnownRobotIsAnsweredBehindAQuestionThatHangs) {
  hold_short_tasks();
  const RobotDescription stranger = [] {
    RobotDescription description = fleet::teacher();
    description.T_tip_transfer.translation().z() += 0.1;
    description.label = "stranger";
    return description;
  }();
  std::future<RegisterReply> unknown = begin_registration(stranger);
  std::future<RegisterReply> known = begin_registration(fleet::teacher());
  ASSERT_TRUE(comes(known));
  EXPECT_EQ(known.get().status, RegisterStatus::Known);
  EXPECT_EQ(unknown.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  hang_.let_go();
  EXPECT_EQ(unknown.get().status, RegisterStatus::Registered);
}

TEST_F(SilentStore, WhatMemoryKnowsIsToldBehindAQuestionThatHangs) {
  hold_short_tasks();
  std::future<AdminPage> tasks = begin_asking(AdminVerb::ListTasks);
  for (const AdminVerb verb : {AdminVerb::Status, AdminVerb::ListJobs, AdminVerb::ListClients}) {
    std::future<AdminPage> page = begin_asking(verb);
    ASSERT_TRUE(comes(page)) << static_cast<int>(verb);
    EXPECT_EQ(page.get().status, AdminStatus::Ok);
  }
  for (const BoundUse& bound : service_->status().bounds)
    if (bound.what == "short tasks that wait") {
      EXPECT_EQ(bound.used, 1U);
    }
  EXPECT_EQ(tasks.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
}

TEST_F(SilentStore, AMarkThatIsLookedForInTheStoreKeepsNobodyWaiting) {
  fetch(request_for(teacher_));
  troubled_->on_lost = [this] { hang_.hold(); };
  const auto reply = std::make_shared<std::promise<ReportReply>>();
  std::future<ReportReply> receipts = reply->get_future();
  std::future<void> taken = std::async(std::launch::async, [this, reply] {  // as the server's loop
    service_->reports().report(
        {fleet::solved(teacher_, "shelf", 1, 50), {}, ConsistencyToken(40, 7)},
        [reply](const ReportReply& r) { reply->set_value(r); });
  });
  ASSERT_TRUE(hang_.wait_until_asked());
  EXPECT_TRUE(comes(taken));
  EXPECT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Ready);
  hang_.let_go();
  EXPECT_EQ(receipts.get().receipts.at(0).status, ReceiptStatus::Stored);
}

TEST_F(SilentStore, StatusIsOfBeforeAndSaysWhyUntilItAnswersAgain) {
  const auto status_of_store = [this] {
    ServerStatus status = service_->status();
    while (!status.writable)  // 50 ms are not enough for every machine
      status = service_->status();
    return status;
  };
  ASSERT_EQ(status_of_store().attempts, 6U);
  report({fleet::solved(teacher_, "shelf", 50)});
  ASSERT_EQ(status_of_store().attempts, 7U);
  troubled_->on_status = [this] { hang_.hold(); };
  report({fleet::solved(teacher_, "shelf", 51)});
  for (int i = 0; i < 3; ++i) {
    const ServerStatus silent = service_->status();
    EXPECT_EQ(silent.attempts, 7U);
    EXPECT_FALSE(silent.writable);
    EXPECT_NE(silent.storage_message.find("the store does not answer"), std::string::npos)
        << silent.storage_message;
  }
  hang_.let_go();
  const ServerStatus answered = status_of_store();
  EXPECT_EQ(answered.attempts, 8U);
  EXPECT_EQ(answered.storage_message.find("does not answer"), std::string::npos);
}

TEST_F(SilentStore, WhatItThrowsIsThrown) {
  troubled_->on_status = [] { throw Failure(ErrorCode::Storage, "the disk is gone"); };
  try {
    service_->status();
    ADD_FAILURE();
  } catch (const Failure& failure) {
    EXPECT_STREQ(failure.what(), "the disk is gone");
  }
  troubled_->on_status = [] {};
  EXPECT_EQ(service_->status().attempts, 6U);
}

}  // namespace
}  // namespace kinship::service::silent_store_test
