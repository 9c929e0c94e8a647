#include "server/service/measures.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

namespace kinship::service::measures_test {
namespace {

using std::chrono::milliseconds;

class Measuring : public testing::Test {
 protected:
  FetchReply ready(std::int64_t fitted_ms) const {
    FetchReply reply;
    reply.status = FetchStatus::Ready;
    reply.distribution.emplace();
    reply.distribution->fitted_ms = fitted_ms;
    return reply;
  }
  std::uint64_t count_of(FetchOutcome outcome) const {
    const metrics::Histogram& histogram = measures_.fetches[static_cast<std::size_t>(outcome)];
    std::uint64_t count = 0;
    for (std::size_t i = 0; i <= metrics::Histogram::kBounds_s.size(); ++i)
      count += histogram.count(i);
    return count;
  }

  std::chrono::steady_clock::time_point now_;
  std::int64_t unix_ms_ = 1000;
  runtime::Clock clock_{[this] { return now_; }, [this] { return unix_ms_; }};
  Measures measures_;
};

TEST_F(Measuring, AReadyReplyCameFromMemoryTheStoreOrAFit) {
  FetchWatch at_once(clock_);
  at_once.set_answered();
  at_once.set_asked();
  measures_.count(ready(900), at_once);
  FetchWatch later(clock_);
  later.set_asked();
  later.set_answered();
  measures_.count(ready(999), later);
  measures_.count(ready(1000), later);
  EXPECT_EQ(count_of(FetchOutcome::Memory), 1U);
  EXPECT_EQ(count_of(FetchOutcome::Store), 1U);
  EXPECT_EQ(count_of(FetchOutcome::Fitted), 1U);
}

TEST_F(Measuring, AWorkerIsNoMemoryHoweverFastItIs) {
  FetchWatch watch(clock_);
  std::thread([&] { watch.set_answered(); }).join();
  watch.set_asked();
  measures_.count(ready(900), watch);
  EXPECT_EQ(count_of(FetchOutcome::Store), 1U);
}

TEST_F(Measuring, EveryStatusIsAnOutcomeOfItsOwn) {
  FetchWatch watch(clock_);
  watch.set_answered();
  for (const FetchStatus status :
       {FetchStatus::Pending, FetchStatus::NoExperience, FetchStatus::UnknownRobot,
        FetchStatus::Busy, FetchStatus::Refused, FetchStatus::Failed}) {
    FetchReply reply;
    reply.status = status;
    measures_.count(reply, watch);
  }
  for (const FetchOutcome outcome :
       {FetchOutcome::Pending, FetchOutcome::NoExperience, FetchOutcome::UnknownRobot,
        FetchOutcome::Busy, FetchOutcome::Refused, FetchOutcome::Failed})
    EXPECT_EQ(count_of(outcome), 1U) << kFetchOutcomeNames[static_cast<std::size_t>(outcome)];
  EXPECT_EQ(count_of(FetchOutcome::Memory), 0U);
}

TEST_F(Measuring, LatencyIsFromTheFetchToItsReply) {
  FetchWatch watch(clock_);
  now_ += milliseconds(300);
  watch.set_answered();
  now_ += milliseconds(200);
  measures_.count(ready(0), watch);
  EXPECT_DOUBLE_EQ(measures_.fetches[0].sum_s(), 0.5);
}

TEST_F(Measuring, ReceiptsFitsAndJobsAreCountedByHowTheyEnded) {
  const std::vector<Receipt> receipts = {{{}, ReceiptStatus::Stored, {}},
                                         {{}, ReceiptStatus::UnknownRobot, {}},
                                         {{}, ReceiptStatus::Stored, {}}};
  measures_.count(receipts, milliseconds(2));
  EXPECT_EQ(measures_.attempts[0].value(), 2U);
  EXPECT_EQ(measures_.attempts[5].value(), 1U);
  EXPECT_EQ(kReceiptNames[5], "unknown_robot");
  Distribution distribution;
  distribution.fit_time_s = 2;
  measures_.count(distribution);
  distribution.state = DistributionState::Failed;
  measures_.count(distribution);
  EXPECT_DOUBLE_EQ(measures_.fits.sum_s(), 2);
  EXPECT_EQ(measures_.failed_fits.value(), 1U);
  Job job;
  for (const JobState state : {JobState::Running, JobState::Done, JobState::Cancelled}) {
    job.state = state;
    measures_.count(job);
  }
  EXPECT_EQ(measures_.jobs[0].value(), 1U);
  EXPECT_EQ(measures_.jobs[1].value(), 0U);
  EXPECT_EQ(measures_.jobs[2].value(), 1U);
}

}  // namespace
}  // namespace kinship::service::measures_test
