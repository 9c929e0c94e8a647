// A distribution that somebody follows is kept up with the experience without being fetched.

#include <gtest/gtest.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <vector>

#include "server/catalog/freshness.hpp"
#include "tests/unit/server/service/service_fixture.hpp"

namespace kinship::service::following_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class Following : public ServiceFixture {
 protected:
  Following() {
    adjust_ = [this](ServiceOptions& options) {
      options.on_announcement = [this](const Announcement& announcement) {
        const std::lock_guard lock(mutex_);
        announced_.push_back(announcement);
        changed_.notify_all();
      };
      options.on_unfollowed = [this](const Digest& id) {
        const std::lock_guard lock(mutex_);
        unfollowed_.push_back(id);
      };
      options.wake = [this] {
        const std::lock_guard lock(mutex_);
        ++wakes_;
        changed_.notify_all();
      };
    };
    start();
  }

  void teach(int paths, std::uint64_t first_seed) {
    report(fleet::solved(teacher_, "shelf", paths, first_seed));
  }
  static FetchRequest following(FetchRequest request, seconds time = seconds(3600)) {
    request.follow = time;
    return request;
  }
  static FetchRequest at_once(FetchRequest request) {
    request.deadline = milliseconds(0);
    return request;
  }
  Announcement wait_for_announcement(std::size_t number) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return announced_.size() >= number; });
    return announced_[number - 1];
  }
  std::size_t announcements() {
    const std::lock_guard lock(mutex_);
    return announced_.size();
  }
  /// Sets the clock to the next deadline and does what is due then, as the server's loop would.
  void run_to_next_deadline() {
    const auto next = service_->next_deadline();
    ASSERT_TRUE(next);
    advance(std::chrono::ceil<milliseconds>(std::max(*next - clock_.now(), {})));
    service_->expire(clock_.now());
  }
  /// Returns when the short task pool has done what it was given before.
  void wait_for_short_tasks() { administer(fleet::question(AdminVerb::ListTasks)); }
  /// A waiter's fetch with a deadline may be among the deadlines: it must be gone first.
  bool is_anything_due() { return service_->next_deadline().has_value(); }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Announcement> announced_;  // these are guarded by mutex_
  std::vector<Digest> unfollowed_;
  int wakes_ = 0;
};

TEST_F(Following, GrownExperienceIsFittedAndAnnouncedWithoutAFetch) {
  teach(6, 1);
  const FetchReply first = fetch(following(request_for(pupil_)));
  ASSERT_EQ(first.status, FetchStatus::Ready) << first.message;
  EXPECT_EQ(wait_for_announcement(1).revision, 1U) << "it is followed since before its fit";
  EXPECT_FALSE(is_anything_due());

  const auto fitted = clock_.now();
  teach(5, 100);
  EXPECT_EQ(service_->next_deadline(), fitted + catalog::kRefitInterval);
  run_to_next_deadline();
  const Announcement second = wait_for_announcement(2);
  EXPECT_EQ(second.revision, 2U);
  EXPECT_EQ(second.distribution_id, first.distribution->id);
  EXPECT_EQ(second.robot, pupil_.digest);
  EXPECT_EQ(second.task, "shelf");
  EXPECT_EQ(second.store_epoch, first.distribution->store_epoch);
  EXPECT_EQ(fetch(at_once(request_for(pupil_))).distribution->revision, 2U);
  EXPECT_EQ(gate_.calls(), 2);
  EXPECT_FALSE(is_anything_due());
}

TEST_F(Following, TheLoopIsWokenWhenItsDeadlineComesNearer) {
  teach(6, 1);
  fetch(following(request_for(pupil_)));
  wait_for_announcement(1);
  const int before = [this] {
    const std::lock_guard lock(mutex_);
    return wakes_;
  }();
  teach(5, 100);
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return wakes_ > before; });
}

TEST_F(Following, LittleGrowthIsLookedAtAndLeftAlone) {
  teach(6, 1);
  fetch(following(request_for(pupil_)));
  teach(4, 100);
  run_to_next_deadline();
  wait_for_short_tasks();
  EXPECT_FALSE(is_anything_due());
  EXPECT_EQ(gate_.calls(), 1);
  teach(1, 200);  // that makes five
  run_to_next_deadline();
  EXPECT_EQ(wait_for_announcement(2).revision, 2U);
}

TEST_F(Following, WhatNobodyFollowsIsLeftAlone) {
  teach(6, 1);
  fetch(request_for(pupil_));
  teach(50, 100);
  advance(catalog::kRefitInterval);
  service_->expire(clock_.now());
  EXPECT_FALSE(is_anything_due());
  EXPECT_EQ(announcements(), 0U);
  EXPECT_EQ(service_->status().followed, 0U);
  EXPECT_EQ(gate_.calls(), 1);
}

TEST_F(Following, ALeaseLapses) {
  teach(6, 1);
  const FetchReply reply = fetch(following(request_for(pupil_), seconds(60)));
  EXPECT_EQ(service_->status().followed, 1U);
  advance(seconds(30));
  fetch(following(at_once(request_for(pupil_)), seconds(60)));  // extended to 90 s
  advance(seconds(59));
  EXPECT_EQ(service_->status().followed, 1U);
  advance(seconds(1));
  EXPECT_EQ(service_->status().followed, 0U);
  service_->expire(clock_.now());
  EXPECT_EQ(unfollowed_, std::vector<Digest>{reply.distribution->id});
  teach(5, 100);
  EXPECT_FALSE(is_anything_due());
}

TEST_F(Following, ReportsThatArriveDuringAFitAreNotForgotten) {
  teach(6, 1);
  gate_.close();
  fetch(following(at_once(request_for(pupil_))));
  gate_.wait_for_calls(1);
  teach(5, 100);  // the fit may read them, but it was begun before
  gate_.open();
  wait_for_announcement(1);
  ASSERT_TRUE(is_anything_due());
  run_to_next_deadline();
  wait_for_short_tasks();
  EXPECT_FALSE(is_anything_due());
  EXPECT_EQ(fetch(at_once(request_for(pupil_))).distribution->sources[0].paths, 11U);
}

TEST_F(Following, AFitThatTheQueueHadNoRoomForIsBegunLater) {
  fit_threads_ = 1;
  fit_queue_ = 1;
  start();
  teach(6, 1);
  fetch(following(request_for(pupil_)));
  teach(5, 100);
  const auto elsewhere = [this](double x_m) {
    FetchRequest request = at_once(request_for(teacher_));
    request.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(x_m, 0, 0));
    return request;
  };
  gate_.close();  // one fit runs, one fills the queue
  fetch(elsewhere(0.1));
  gate_.wait_for_calls(2);
  fetch(elsewhere(0.2));
  wait_for_short_tasks();
  run_to_next_deadline();
  wait_for_short_tasks();
  EXPECT_EQ(gate_.calls(), 2);
  gate_.open();
  EXPECT_EQ(begin_fetch(elsewhere(0.2), "two").get().status == FetchStatus::Busy, false);
  while (service_->status().queued_fits > 0)
    std::this_thread::yield();
  run_to_next_deadline();
  EXPECT_EQ(wait_for_announcement(2).revision, 2U);
}

TEST_F(Following, ReportsOneByOneAreNotEachAReasonToAskTheStore) {
  teach(6, 1);
  fetch(following(request_for(pupil_)));
  advance(catalog::kRefitInterval);
  teach(1, 100);
  run_to_next_deadline();
  wait_for_short_tasks();
  const auto looked = clock_.now();
  teach(1, 101);
  EXPECT_GT(*service_->next_deadline(), looked + milliseconds(500));
}

TEST_F(Following, AfterARestartThereIsNoLeaseUntilItIsRenewed) {
  teach(6, 1);
  fetch(following(request_for(pupil_)));
  start();
  EXPECT_EQ(service_->status().followed, 0U);
  EXPECT_EQ(fetch(following(request_for(pupil_))).distribution->revision, 1U);
  EXPECT_EQ(service_->status().followed, 1U);
  teach(5, 100);
  run_to_next_deadline();
  EXPECT_EQ(wait_for_announcement(2).revision, 2U);
}

TEST_F(Following, RetiredExperienceIsReplacedAtOnce) {
  teach(6, 1);
  const std::vector<Attempt> bad = fleet::solved(teacher_, "shelf", 1, 50);
  report(bad);
  fetch(following(request_for(pupil_)));
  wait_for_announcement(1);
  administer(fleet::question(AdminVerb::RetirePath, bad[0].report_uuid.text()));
  ASSERT_TRUE(is_anything_due());
  run_to_next_deadline();
  EXPECT_EQ(wait_for_announcement(2).revision, 2U);
  EXPECT_EQ(fetch(at_once(request_for(pupil_))).distribution->sources[0].paths, 6U);
}

TEST_F(Following, AnEvictedDistributionIsFittedAgain) {
  teach(6, 1);
  const FetchReply reply = fetch(following(request_for(pupil_)));
  wait_for_announcement(1);
  administer(fleet::question(AdminVerb::EvictDistribution, reply.distribution->id.hex()));
  run_to_next_deadline();
  EXPECT_EQ(wait_for_announcement(2).revision, 2U);
}

TEST_F(Following, AnUnknownRobotHoldsNoLease) {
  FetchRequest request = following(request_for(teacher_));
  request.robot.bytes[0] ^= 1U;
  EXPECT_EQ(fetch(request).status, FetchStatus::UnknownRobot);
  EXPECT_EQ(service_->status().followed, 0U);
}

}  // namespace
}  // namespace kinship::service::following_test
