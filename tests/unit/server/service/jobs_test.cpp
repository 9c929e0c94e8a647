#include "server/service/jobs.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <future>
#include <memory>
#include <mutex>
#include <string>

#include "proto/types/failure.hpp"
#include "server/service/job_rows.hpp"

namespace kinship::service::jobs_test {
namespace {

using std::chrono::milliseconds;

/// Jobs under a clock that the test sets, and work that waits until the test lets it go on.
class JobsTest : public testing::Test {  // NOLINT: GoogleTest deletes it
 protected:
  JobsTest() { make({}); }
  ~JobsTest() override { let_go(); }

  void make(const Jobs::Limits& limits) {
    jobs_ = std::make_unique<Jobs>(
        clock_, Jobs::Options{.limits = limits, .niceness = 0, .on_end = [this](const Job& job) {
                                const std::lock_guard lock(mutex_);
                                ended_ += job.argument + " ";
                              }});
  }

  /// Waits for let_go(); then makes one row, whether it was to stop or not.
  Jobs::Task held(const std::string& argument) {
    return {.verb = "hold", .argument = argument, .request_key = {}, .run = [this](JobRun& run) {
              std::unique_lock lock(mutex_);
              ++begun_;
              changed_.notify_all();
              changed_.wait(lock, [this] { return is_open_; });
              run.rows.add("row");
              return true;
            }};
  }
  /// Runs until it is told to stop.
  Jobs::Task endless() {
    return {.verb = "endless", .argument = "", .request_key = {}, .run = [this](JobRun& run) {
              run.set_progress(0.25);
              std::promise<void> stopped;
              const std::stop_callback callback(run.stop_token(), [&] { stopped.set_value(); });
              count_begun();
              stopped.get_future().wait();
              return false;
            }};
  }
  static Jobs::Task quick(const std::string& argument, std::size_t row_bytes = 0) {
    return {
        .verb = "quick", .argument = argument, .request_key = {}, .run = [row_bytes](JobRun& run) {
          run.message = "made it";
          run.rows.add(std::string(row_bytes, 'x'));
          return true;
        }};
  }
  void count_begun() {
    const std::lock_guard lock(mutex_);
    ++begun_;
    changed_.notify_all();
  }
  void wait_for_begun(int count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return begun_ >= count; });
  }
  void let_go() {
    const std::lock_guard lock(mutex_);
    is_open_ = true;
    changed_.notify_all();
  }
  std::string begin(Jobs::Task task) { return jobs_->begin(std::move(task)).value_or_throw().id; }
  std::future<Job> wait(const std::string& id, milliseconds time = milliseconds(1000)) {
    const auto job = std::make_shared<std::promise<Job>>();
    jobs_->wait(id, clock_.now() + time,
                [job](const Result<Job>& result) { job->set_value(result.value()); });
    return job->get_future();
  }
  Job end_of(const std::string& id) { return wait(id).get(); }
  JobState state_of(const std::string& id) { return jobs_->find(id).value_or_throw().state; }
  static bool is_there_yet(const std::future<Job>& job) {
    return job.wait_for(milliseconds(0)) == std::future_status::ready;
  }

  std::atomic<std::int64_t> time_ms_{1'000'000};
  runtime::Clock clock_{
      .now = [this] { return std::chrono::steady_clock::time_point(milliseconds(time_ms_)); },
      .unix_ms = [this] { return time_ms_.load(); }};
  std::mutex mutex_;
  std::condition_variable changed_;
  int begun_ = 0;
  bool is_open_ = false;
  std::string ended_;
  std::unique_ptr<Jobs> jobs_;  // last: its thread uses all of the above
};

TEST_F(JobsTest, AreListedFromTheLastThatWasBegunPageByPage) {
  for (const char* const argument : {"a", "b", "c", "d", "e"})
    begin(held(argument));
  std::string listed, cursor;
  do {
    const store::Page<Job> page = jobs_->list(cursor, 2);
    for (const Job& job : page.rows)
      listed += job.argument;
    cursor = page.next_cursor;
    if (listed.size() == 2)
      begin(held("f"));  // comes before what was shown
  } while (!cursor.empty());
  EXPECT_EQ(listed, "edcba");
  EXPECT_TRUE(jobs_->list("forgotten", 2).rows.empty());
}

TEST_F(JobsTest, AJobIsDoneWithItsMessageAndRows) {
  const Job job = end_of(begin(quick("one")));
  EXPECT_EQ(job.state, JobState::Done);
  EXPECT_EQ(job.verb, "quick");
  EXPECT_EQ(job.message, "made it");
  EXPECT_EQ(job.rows, 1U);
  EXPECT_EQ(job.progress, 1);
  EXPECT_EQ(job.started_ms, 1'000'000);
  EXPECT_EQ(job.ended_ms, 1'000'000);
  EXPECT_EQ(ended_, "one ");
}

TEST_F(JobsTest, IdsAreEightHexadecimalDigits) {
  const std::string id = begin(quick("one"));
  EXPECT_EQ(id.size(), 8U);
  EXPECT_EQ(id.find_first_not_of("0123456789abcdef"), std::string::npos) << id;
  EXPECT_NE(id, begin(quick("two")));
}

TEST_F(JobsTest, WhatAJobThrowsIsWhyItFailed) {
  Jobs::Task task = quick("one");
  task.run = [](JobRun&) -> bool { throw std::runtime_error("disk is full"); };
  const Job job = end_of(begin(std::move(task)));
  EXPECT_EQ(job.state, JobState::Failed);
  EXPECT_EQ(job.message, "disk is full");
}

TEST_F(JobsTest, OneRunsAtATimeInTheOrderOfBeginning) {
  const std::string first = begin(held("a"));
  const std::string second = begin(held("b"));
  wait_for_begun(1);
  EXPECT_EQ(state_of(first), JobState::Running);
  EXPECT_EQ(state_of(second), JobState::Queued);
  EXPECT_EQ(jobs_->active(), 2U);
  let_go();
  end_of(second);
  EXPECT_EQ(ended_, "a b ");
  EXPECT_EQ(jobs_->active(), 0U);
}

TEST_F(JobsTest, ListsThemWithTheirProgress) {
  const std::string id = begin(endless());
  const std::string other = begin(quick("two"));
  wait_for_begun(1);
  const std::vector<Job> jobs = jobs_->list("", 10).rows;
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_EQ(jobs[0].id, other);
  EXPECT_EQ(jobs[1].id, id);
  EXPECT_EQ(jobs[1].progress, 0.25);
  jobs_->cancel(id).value_or_throw();
}

TEST_F(JobsTest, TooManyThatWaitAreRefusedWithTheLimit) {
  make({.queued = 2});
  begin(held("running"));
  wait_for_begun(1);
  begin(held("a"));
  begin(held("b"));
  const Result<Job> refused = jobs_->begin(held("c"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::Unavailable);
  EXPECT_NE(refused.error().message.find("busy: 2 jobs wait already"), std::string::npos)
      << refused.error().message;
}

TEST_F(JobsTest, AnOwnerHasSoManyThatHaveNotEnded) {
  make({.client_active = 2});
  const auto of = [this](const std::string& owner) {
    Jobs::Task task = held("x");
    task.owner = owner;
    return jobs_->begin(std::move(task));
  };
  const std::string running = of("anna").value_or_throw().id;
  const std::string waiting = of("anna").value_or_throw().id;
  const Result<Job> third = of("anna");
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().code, ErrorCode::Unavailable);
  EXPECT_NE(third.error().message.find("this client has 2 jobs"), std::string::npos)
      << third.error().message;
  EXPECT_EQ(jobs_->refusal_of("anna")->message, third.error().message);
  EXPECT_TRUE(of("ben"));
  for (int i = 0; i < 3; ++i)
    EXPECT_TRUE(of("")) << "nobody in particular";
  jobs_->cancel(waiting).value_or_throw();
  EXPECT_TRUE(of("anna"));
}

TEST_F(JobsTest, TheEndedOnesOfOneOwnerPushOutNobodyElses) {
  make({.kept = 8, .client_kept = 4});
  const auto of = [this](const std::string& owner) {
    Jobs::Task task = quick(owner);
    task.owner = owner;
    const std::string id = begin(std::move(task));
    end_of(id);
    return id;
  };
  const std::string of_anna = of("anna"), first_of_ben = of("ben");
  for (int i = 0; i < 20; ++i)
    of("ben");
  EXPECT_TRUE(jobs_->find(of_anna));
  EXPECT_FALSE(jobs_->find(first_of_ben));
  EXPECT_EQ(jobs_->list("", 100).rows.size(), 5U);
}

TEST_F(JobsTest, ACancelledJobThatWaitedFreesItsPlaceAndNeverRuns) {
  make({.queued = 1});
  begin(held("running"));
  wait_for_begun(1);
  const std::string waiting = begin(held("waiting"));
  EXPECT_FALSE(jobs_->begin(held("too many")));
  const Job job = jobs_->cancel(waiting).value_or_throw();
  EXPECT_EQ(job.state, JobState::Cancelled);
  EXPECT_EQ(job.message, "cancelled before it began");
  const std::string next = begin(held("next"));
  let_go();
  end_of(next);
  EXPECT_EQ(begun_, 2);
  EXPECT_EQ(state_of(waiting), JobState::Cancelled);
}

TEST_F(JobsTest, ARunningJobIsToldToStop) {
  const std::string id = begin(endless());
  wait_for_begun(1);
  jobs_->cancel(id).value_or_throw();
  const Job job = end_of(id);
  EXPECT_EQ(job.state, JobState::Cancelled);
  EXPECT_EQ(job.message, "cancelled");
  EXPECT_EQ(job.rows, 0U);
}

TEST_F(JobsTest, AJobThatFinishesBeforeItNoticesIsDone) {
  const std::string id = begin(held("a"));
  wait_for_begun(1);
  EXPECT_EQ(jobs_->cancel(id).value_or_throw().state, JobState::Running);
  let_go();
  EXPECT_EQ(end_of(id).state, JobState::Done);
  EXPECT_EQ(jobs_->cancel(id).value_or_throw().state, JobState::Done);
  EXPECT_EQ(jobs_->rows(id, 0, 10, 1000).value_or_throw().rows.size(), 1U);
}

TEST_F(JobsTest, ARequestSentAgainGetsTheSameJob) {
  Jobs::Task task = held("a");
  task.request_key = "client 1, request 7";
  const std::string id = begin(task);
  EXPECT_EQ(begin(task), id);
  task.request_key = "client 1, request 8";
  const std::string other = begin(task);
  EXPECT_NE(other, id);
  let_go();
  end_of(other);
  EXPECT_EQ(begin(task), other);  // also when it has ended
  EXPECT_EQ(jobs_->begun_by(task.request_key).value().id, other);
  EXPECT_FALSE(jobs_->begun_by(""));
  EXPECT_EQ(begun_, 2);
}

TEST_F(JobsTest, WhoWaitsIsAnsweredAtTheEndOrAtTheDeadline) {
  const std::string id = begin(held("a"));
  wait_for_begun(1);
  std::future<Job> patient = wait(id, milliseconds(5000));
  std::future<Job> hasty = wait(id, milliseconds(100));
  EXPECT_EQ(jobs_->next_deadline(), clock_.now() + milliseconds(100));
  time_ms_ += 99;
  jobs_->expire(clock_.now());
  EXPECT_FALSE(is_there_yet(hasty));
  time_ms_ += 1;
  jobs_->expire(clock_.now());
  ASSERT_TRUE(is_there_yet(hasty));
  EXPECT_EQ(hasty.get().state, JobState::Running);
  EXPECT_FALSE(is_there_yet(patient));
  let_go();
  EXPECT_EQ(patient.get().state, JobState::Done);
}

TEST_F(JobsTest, WhoDoesNotWaitIsAnsweredAtOnce) {
  const std::string id = begin(held("a"));
  std::future<Job> job = wait(id, milliseconds(0));
  EXPECT_TRUE(is_there_yet(job));
}

TEST_F(JobsTest, UnknownJobsAreNotFound) {
  EXPECT_EQ(jobs_->find("01234567").error().code, ErrorCode::NotFound);
  EXPECT_EQ(jobs_->cancel("01234567").error().message, "no job '01234567'");
  EXPECT_EQ(jobs_->rows("01234567", 0, 1, 1).error().code, ErrorCode::NotFound);
  bool is_answered = false;
  jobs_->wait("01234567", clock_.now() + milliseconds(100), [&](const Result<Job>& job) {
    is_answered = !job && job.error().code == ErrorCode::NotFound;
  });
  EXPECT_TRUE(is_answered);
}

TEST_F(JobsTest, OnlyAJobThatIsDoneHasRows) {
  const std::string id = begin(held("a"));
  EXPECT_NE(jobs_->rows(id, 0, 1, 1000).error().message.find("it has no rows yet"),
            std::string::npos);
  let_go();
  end_of(id);
  const Jobs::RowPage page = jobs_->rows(id, 0, 1, 1000).value_or_throw();
  EXPECT_EQ(page.rows, std::vector<std::string>{"row"});
  EXPECT_EQ(page.next, 0U);
}

TEST_F(JobsTest, RowsBeyondTheLimitFailTheJob) {
  make({.row_bytes = 100});
  const Job job = end_of(begin(quick("one", 101)));
  EXPECT_EQ(job.state, JobState::Failed);
  EXPECT_NE(job.message.find("a job may keep 100"), std::string::npos) << job.message;
}

TEST_F(JobsTest, EndedJobsAreForgottenByAgeNumberAndSize) {
  make({.kept = 3, .kept_for = milliseconds(1000), .kept_bytes = 1000});
  const std::string big = begin(quick("big", 600));
  end_of(big);
  EXPECT_EQ(jobs_->rows(big, 0, 1, 1000).value_or_throw().rows.at(0).size(), 600U);
  const std::string bigger = begin(quick("bigger", 900));
  end_of(bigger);
  EXPECT_FALSE(jobs_->find(big)) << "together they exceed 1000 bytes";
  for (int i = 0; i < 3; ++i)
    end_of(begin(quick("small")));
  EXPECT_FALSE(jobs_->find(bigger)) << "the fourth";
  EXPECT_EQ(jobs_->list("", 100).rows.size(), 3U);
  time_ms_ += 1000;
  EXPECT_EQ(jobs_->next_deadline(), clock_.now());
  jobs_->expire(clock_.now());
  EXPECT_TRUE(jobs_->list("", 100).rows.empty());
  EXPECT_FALSE(jobs_->next_deadline());
}

TEST_F(JobsTest, StoppingCancelsEverythingAndAnswersWhoWaits) {
  const std::string running = begin(endless());
  wait_for_begun(1);
  const std::string queued = begin(quick("queued"));
  std::future<Job> first = wait(running), second = wait(queued);
  jobs_->stop();
  EXPECT_EQ(first.get().state, JobState::Cancelled);
  EXPECT_EQ(second.get().message, "the server is stopping");
  EXPECT_EQ(jobs_->begin(quick("late")).error().message, "the server is stopping");
  jobs_->stop();
}

using Rows = std::vector<std::string>;

JobRows some_rows() {
  JobRows rows(1000);
  for (const char* row : {"one", "", "three", "four"})
    rows.add(row);
  return rows;
}

TEST(JobRows, ComeOutAsTheyWentIn) {
  EXPECT_EQ(some_rows().page(0, 10, 1000), (Rows{"one", "", "three", "four"}));
}

TEST(JobRows, APageHasALimitOfRowsAndOfBytes) {
  EXPECT_EQ(some_rows().page(1, 2, 1000), (Rows{"", "three"}));
  EXPECT_EQ(some_rows().page(0, 10, 8), (Rows{"one", "", "three"}));
  EXPECT_EQ(some_rows().page(0, 10, 7), (Rows{"one", ""}));
}

TEST(JobRows, ARowLongerThanAPageIsAPageOfItsOwn) {
  EXPECT_EQ(some_rows().page(2, 10, 1), Rows{"three"});
}

TEST(JobRows, NothingFollowsTheLastRow) { EXPECT_TRUE(some_rows().page(4, 10, 1000).empty()); }

TEST(JobRows, TheErrorNamesRowSizeAndLimit) {
  JobRows rows(24);
  rows.add("12345678");  // and 8 bytes for where it ends
  try {
    rows.add("1");
    FAIL() << "no error";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::TooLarge);
    EXPECT_STREQ(failure.what(),
                 "row 2 needs 25 bytes together with those before it, a job may keep 24");
  }
  EXPECT_EQ(rows.size(), 1U);
}

}  // namespace
}  // namespace kinship::service::jobs_test
