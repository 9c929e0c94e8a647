#include "server/catalog/advice_cache.hpp"

#include <gtest/gtest.h>

#include <mutex>
#include <thread>
#include <vector>

#include "proto/types/failure.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::catalog::advice_cache_test {
namespace {

constexpr double kProfileShare = 0.9;
const Digest kDistribution = test::id_from<Digest>(1);
const Context kContext{"engines 2", "default"};

AttemptCost cost(SamplingMode mode, std::uint64_t checks, Outcome outcome = Outcome::Solved) {
  return {"shelf", {}, mode, outcome, checks, "birrt", kDistribution};
}

class AdviceCacheTest : public testing::Test {
 protected:
  void run_later() {
    std::vector<std::function<void()>> waiting;
    {
      const std::scoped_lock lock(mutex_);
      waiting.swap(waiting_);
    }
    for (const auto& run : waiting)
      run();
  }
  Advice advise() { return advice_.advise("shelf", {}, kContext, kProfileShare); }
  std::uint64_t version() const { return advice_.version("shelf", {}); }

  store::AttemptTotals stored_;
  int readings_ = 0;
  std::function<std::optional<Context>(const Digest&)> find_context_ =
      [](const Digest& id) -> std::optional<Context> {
    return id == kDistribution ? std::optional(kContext) : std::nullopt;
  };
  std::function<void()> on_read_ = [] {};
  std::mutex mutex_;  ///< of `waiting_`: several threads may hand over at once
  std::vector<std::function<void()>> waiting_;
  bool has_room_ = true;
  AdviceCache advice_{[this](const Digest&, const std::string&) {
                        ++readings_;
                        on_read_();
                        return stored_;
                      },
                      [this](const Digest& id) { return find_context_(id); },
                      [this](std::function<void()> run) {
                        const std::scoped_lock lock(mutex_);
                        if (has_room_)
                          waiting_.push_back(std::move(run));
                        return has_room_;
                      }};
};

TEST_F(AdviceCacheTest, UntilTheStoreHasAnsweredTheProfileDecides) {
  const Advice advice = advise();
  EXPECT_EQ(advice.recommended_share, kProfileShare);
  EXPECT_EQ(advice.evidence, "attempts are being counted: share of the profile");
  EXPECT_EQ(version(), 0U);
  advise();
  EXPECT_EQ(waiting_.size(), 1U) << "one reading is enough";
  EXPECT_EQ(readings_, 0) << "nobody waits for the store";
}

TEST_F(AdviceCacheTest, ThenTheStoredAttemptsDo) {
  stored_.guided.attempts = 7;
  stored_.guided.checks = 700;
  advise();
  run_later();
  EXPECT_EQ(version(), 1U);
  EXPECT_EQ(advise().guided->attempts, 7U);
  run_later();
  EXPECT_EQ(readings_, 1);
}

TEST_F(AdviceCacheTest, CommittedAttemptsAreAddedToTheirArm) {
  advise();
  run_later();
  for (int i = 0; i < 12; ++i) {
    advice_.add(cost(SamplingMode::Guided, 2000));
    advice_.add(cost(SamplingMode::Control, 1000, i < 6 ? Outcome::Solved : Outcome::Timeout));
    advice_.add(cost(SamplingMode::Uniform, 5));
  }
  const Advice advice = advise();
  EXPECT_EQ(*advice.guided, (ModeEvidence{12, 12, 2000}));
  EXPECT_EQ(*advice.control, (ModeEvidence{12, 6, 2000}));
  EXPECT_EQ(version(), 25U);
  EXPECT_EQ(readings_, 1);
}

/// Of a machine of this speed.
AttemptCost timed_cost(SamplingMode mode, double processor_time_s, double machine_speed) {
  Attempt attempt = test::make_attempt({}, "shelf", 1);
  attempt.record.sampling_mode = mode;
  attempt.record.distribution_id = kDistribution;
  attempt.record.processor_time_s = processor_time_s;
  attempt.record.machine_speed = machine_speed;
  return cost_of(attempt);
}

TEST_F(AdviceCacheTest, TimesOfMachinesThatDifferAreComparedAsOfOne) {
  advise();
  run_later();
  for (int i = 0; i < 30; ++i) {
    advice_.add(timed_cost(SamplingMode::Guided, 0.008, 0.25));  // a slow machine guides
    advice_.add(timed_cost(SamplingMode::Control, 0.004, 1));    // a fast one does not
  }
  run_later();
  EXPECT_DOUBLE_EQ(advise().recent.back().time_s, 0.004);
  EXPECT_NE(advise().evidence.find("by processor time, typical ratio uniform / guided 1.9"),
            std::string::npos)
      << advise().evidence;
  EXPECT_EQ(advise().recommended_share, kProfileShare);
}

TEST_F(AdviceCacheTest, ATimeOfAMachineOfUnknownSpeedIsNoTime) {
  advise();
  run_later();
  for (int i = 0; i < 30; ++i) {
    advice_.add(timed_cost(SamplingMode::Guided, 0.008, 0));
    advice_.add(timed_cost(SamplingMode::Control, 0.004, 1));
  }
  run_later();
  EXPECT_NE(advise().evidence.find("; typical ratio uniform / guided 1.0"), std::string::npos)
      << advise().evidence << ": equal checks";
}

TEST_F(AdviceCacheTest, RecentAttemptsGoOnFromTheStoredOnes) {
  stored_.recent = {{{SamplingMode::Control, true, 700, 0}, "birrt", kDistribution}};
  advise();
  run_later();
  advice_.add(cost(SamplingMode::Guided, 300, Outcome::Timeout));
  advice_.add(cost(SamplingMode::Uniform, 5));
  advice_.add(cost(SamplingMode::Guided, 1, Outcome::Failed));  // a start in collision, say
  EXPECT_EQ(advise().recent, (std::vector<JudgedAttempt>{{SamplingMode::Control, true, 700, 1},
                                                         {SamplingMode::Guided, false, 300, 0}}));
}

TEST_F(AdviceCacheTest, DistributionsThatAttemptsNameAreLookedUpBehindTheirBack) {
  const Digest newer = test::id_from<Digest>(2);
  int look_ups = 0;
  find_context_ = [&](const Digest&) -> std::optional<Context> {
    if (++look_ups == 1)
      throw Failure(ErrorCode::Storage, "disk");
    return kContext;
  };
  advise();
  run_later();
  AttemptCost attempt = cost(SamplingMode::Guided, 300);
  attempt.distribution_id = newer;
  advice_.add(attempt);
  EXPECT_EQ(look_ups, 0) << "nobody waits for the store";
  EXPECT_EQ(advise().recent.back().age, kAgeOfUnknown) << "of an unknown context until then";
  run_later();
  advice_.add(attempt);  // the first look-up failed
  const std::uint64_t before = version();
  run_later();
  EXPECT_GT(version(), before);
  EXPECT_EQ(advise().recent.back().age, 0U);
  advice_.add(attempt);
  run_later();
  EXPECT_EQ(look_ups, 2);
}

TEST_F(AdviceCacheTest, WhatNobodyAskedForIsNotKept) {
  advice_.add(cost(SamplingMode::Guided, 2000));
  EXPECT_EQ(version(), 0U);
  EXPECT_FALSE(advise().guided);
}

TEST_F(AdviceCacheTest, SumsThatWereOvertakenAreReadAgain) {
  advise();
  on_read_ = [this] {
    if (readings_ == 1) {  // committed before the sums were read, told before they were taken over
      stored_.guided.attempts = 1;
      advice_.add(cost(SamplingMode::Guided, 2000));
    }
  };
  run_later();
  EXPECT_EQ(readings_, 2);
  EXPECT_EQ(advise().guided->attempts, 1U) << "counted once";
}

TEST_F(AdviceCacheTest, ReadingEndsAlsoIfItIsAlwaysOvertaken) {
  advise();
  on_read_ = [this] { advice_.add(cost(SamplingMode::Guided, 2000)); };
  run_later();
  EXPECT_EQ(version(), 1U);
}

TEST_F(AdviceCacheTest, AfterAFailureTheNextQuestionReadsAgain) {
  on_read_ = [this] {
    if (readings_ == 1)
      throw Failure(ErrorCode::Storage, "disk");
  };
  advise();
  run_later();
  EXPECT_EQ(version(), 0U);
  advise();
  run_later();
  EXPECT_EQ(version(), 1U);
}

TEST_F(AdviceCacheTest, WithoutRoomTheNextQuestionTriesAgain) {
  has_room_ = false;
  EXPECT_EQ(advise().recommended_share, kProfileShare);
  has_room_ = true;
  advise();
  run_later();
  EXPECT_EQ(version(), 1U);
}

TEST_F(AdviceCacheTest, ThreadsMayAddAndAskAtOnce) {
  advise();
  run_later();
  constexpr int kThreads = 4, kAttempts = 500;
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i)
    threads.emplace_back([this] {
      for (int j = 0; j < kAttempts; ++j) {
        advice_.add(cost(SamplingMode::Guided, 10));
        advice_.advise("shelf", {}, kContext, kProfileShare);
      }
    });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(advise().guided->attempts, static_cast<std::uint64_t>(kThreads * kAttempts));
}

TEST_F(AdviceCacheTest, TellsTheWorthOfGuidanceAsItIsAdvisedNow) {
  EXPECT_TRUE(advice_.worths(10).pairs.empty());
  advise();
  EXPECT_TRUE(advice_.worths(10).pairs.empty()) << "nothing is known yet";
  run_later();
  for (int i = 0; i < 20; ++i) {
    advice_.add(cost(SamplingMode::Guided, 1000));
    advice_.add(cost(SamplingMode::Control, 100));
    run_later();
  }
  const GuidanceWorths worths = advice_.worths(10);
  ASSERT_EQ(worths.pairs.size(), 1U);
  EXPECT_EQ(worths.left_out, 0U);
  EXPECT_EQ(worths.pairs[0].task, "shelf");
  EXPECT_EQ(worths.pairs[0].advice.guided->attempts, 20U);
  EXPECT_EQ(worths.pairs[0].advice.recommended_share, advise().recommended_share);
  EXPECT_LT(worths.pairs[0].advice.recommended_share, kProfileShare);
}

TEST_F(AdviceCacheTest, NothingIsToldOfARobotThatIsRemovedAlsoWhileItsAttemptsAreRead) {
  advise();
  run_later();
  ASSERT_EQ(advice_.worths(10).pairs.size(), 1U);
  advice_.forget(test::id_from<Digest>(7));
  ASSERT_EQ(advice_.worths(10).pairs.size(), 1U) << "another robot was removed";
  advice_.forget({});
  EXPECT_TRUE(advice_.worths(10).pairs.empty());
  EXPECT_EQ(version(), 0U);

  advise();
  on_read_ = [this] { advice_.forget({}); };
  run_later();
  EXPECT_TRUE(advice_.worths(10).pairs.empty());

  on_read_ = [] {};
  advise();  // it is registered again
  run_later();
  EXPECT_EQ(advice_.worths(10).pairs.size(), 1U);
}

TEST_F(AdviceCacheTest, TellsOfThePairsWithMostAttemptsAndHowManyOthersThereAre) {
  for (const char* const task : {"c", "a", "b"})
    advice_.advise(task, {}, kContext, kProfileShare);
  run_later();
  for (const auto& [task, count] : {std::pair("a", 2), std::pair("b", 1), std::pair("c", 3)})
    for (int i = 0; i < count; ++i) {
      AttemptCost attempt = cost(SamplingMode::Guided, 10);
      attempt.task = task;
      advice_.add(attempt);
    }
  const GuidanceWorths worths = advice_.worths(2);
  ASSERT_EQ(worths.pairs.size(), 2U);
  EXPECT_EQ(worths.pairs[0].task, "a");
  EXPECT_EQ(worths.pairs[1].task, "c");
  EXPECT_EQ(worths.left_out, 1U);
}

}  // namespace
}  // namespace kinship::catalog::advice_cache_test
