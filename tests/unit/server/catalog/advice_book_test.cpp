#include "server/catalog/advice_book.hpp"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "proto/types/failure.hpp"

namespace kinship::catalog::advice_book_test {
namespace {

constexpr double kProfileShare = 0.9;

AttemptCost cost(SamplingMode mode, std::uint64_t checks, Outcome outcome = Outcome::Solved) {
  return {"shelf", {}, mode, outcome, checks};
}

class AdviceBookTest : public testing::Test {
 protected:
  void run_later() {
    std::vector<std::function<void()>> waiting;
    waiting.swap(waiting_);
    for (const auto& run : waiting)
      run();
  }
  Advice advise() { return book_.advise("shelf", {}, kProfileShare); }
  std::uint64_t version() const { return book_.version("shelf", {}); }

  store::AttemptTotals stored_;
  int readings_ = 0;
  std::function<void()> on_read_ = [] {};
  std::vector<std::function<void()>> waiting_;
  bool has_room_ = true;
  AdviceBook book_{[this](const Digest&, const std::string&) {
                     ++readings_;
                     on_read_();
                     return stored_;
                   },
                   [this](std::function<void()> run) {
                     if (has_room_)
                       waiting_.push_back(std::move(run));
                     return has_room_;
                   }};
};

TEST_F(AdviceBookTest, UntilTheStoreHasAnsweredTheProfileDecides) {
  const Advice advice = advise();
  EXPECT_EQ(advice.recommended_share, kProfileShare);
  EXPECT_EQ(advice.evidence, "attempts are being counted: share of the profile");
  EXPECT_EQ(version(), 0U);
  advise();
  EXPECT_EQ(waiting_.size(), 1U) << "one reading is enough";
  EXPECT_EQ(readings_, 0) << "nobody waits for the store";
}

TEST_F(AdviceBookTest, ThenTheStoredAttemptsDo) {
  stored_.guided.attempts = 7;
  stored_.guided.checks = 700;
  advise();
  run_later();
  EXPECT_EQ(version(), 1U);
  EXPECT_EQ(advise().guided->attempts, 7U);
  run_later();
  EXPECT_EQ(readings_, 1);
}

TEST_F(AdviceBookTest, CommittedAttemptsAreAddedToTheirArm) {
  advise();
  run_later();
  for (int i = 0; i < 12; ++i) {
    book_.add(cost(SamplingMode::Guided, 2000));
    book_.add(cost(SamplingMode::Control, 1000, i < 6 ? Outcome::Solved : Outcome::Timeout));
    book_.add(cost(SamplingMode::Uniform, 5));
  }
  const Advice advice = advise();
  EXPECT_EQ(*advice.guided, (ModeEvidence{12, 12, 2000}));
  EXPECT_EQ(*advice.control, (ModeEvidence{12, 6, 2000}));
  EXPECT_EQ(version(), 25U);
  EXPECT_EQ(readings_, 1);
}

TEST_F(AdviceBookTest, RecentAttemptsGoOnFromTheStoredOnes) {
  stored_.recent = {{SamplingMode::Control, true, 700, 0}};
  advise();
  run_later();
  book_.add(cost(SamplingMode::Guided, 300, Outcome::Timeout));
  book_.add(cost(SamplingMode::Uniform, 5));
  book_.add(cost(SamplingMode::Guided, 1, Outcome::Failed));  // a start in collision, say
  EXPECT_EQ(advise().recent, (std::vector<JudgedAttempt>{{SamplingMode::Control, true, 700, 1},
                                                         {SamplingMode::Guided, false, 300, 0}}));
}

TEST_F(AdviceBookTest, WhatNobodyAskedForIsNotKept) {
  book_.add(cost(SamplingMode::Guided, 2000));
  EXPECT_EQ(version(), 0U);
  EXPECT_FALSE(advise().guided);
}

TEST_F(AdviceBookTest, SumsThatWereOvertakenAreReadAgain) {
  advise();
  on_read_ = [this] {
    if (readings_ == 1) {  // committed before the sums were read, told before they were taken over
      stored_.guided.attempts = 1;
      book_.add(cost(SamplingMode::Guided, 2000));
    }
  };
  run_later();
  EXPECT_EQ(readings_, 2);
  EXPECT_EQ(advise().guided->attempts, 1U) << "counted once";
}

TEST_F(AdviceBookTest, ReadingEndsAlsoIfItIsAlwaysOvertaken) {
  advise();
  on_read_ = [this] { book_.add(cost(SamplingMode::Guided, 2000)); };
  run_later();
  EXPECT_EQ(version(), 1U);
}

TEST_F(AdviceBookTest, AfterAFailureTheNextQuestionReadsAgain) {
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

TEST_F(AdviceBookTest, WithoutRoomTheNextQuestionTriesAgain) {
  has_room_ = false;
  EXPECT_EQ(advise().recommended_share, kProfileShare);
  has_room_ = true;
  advise();
  run_later();
  EXPECT_EQ(version(), 1U);
}

TEST_F(AdviceBookTest, ThreadsMayAddAndAskAtOnce) {
  advise();
  run_later();
  constexpr int kThreads = 4, kAttempts = 500;
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i)
    threads.emplace_back([this] {
      for (int j = 0; j < kAttempts; ++j) {
        book_.add(cost(SamplingMode::Guided, 10));
        book_.advise("shelf", {}, kProfileShare);
      }
    });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(advise().guided->attempts, static_cast<std::uint64_t>(kThreads * kAttempts));
}

}  // namespace
}  // namespace kinship::catalog::advice_book_test
