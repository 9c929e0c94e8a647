#include "proto/evidence/attempt_window.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace kinship::evidence::attempt_window_test {
namespace {

TEST(AttemptWindow, AddedAttemptsMakeTheOthersOlder) {
  AttemptWindow window(
      {{SamplingMode::Control, true, 500, 3}, {SamplingMode::Guided, false, 900, 0}});
  window.add(SamplingMode::Guided, true, 70, 0.5);
  EXPECT_EQ(window.recent(),
            (std::vector<JudgedAttempt>{{SamplingMode::Control, true, 500, 4},
                                        {SamplingMode::Guided, false, 900, 1},
                                        {SamplingMode::Guided, true, 70, 0, 0.5}}));
}

TEST(AttemptWindow, UniformAttemptsAreNoEvidence) {
  AttemptWindow window({{SamplingMode::Uniform, true, 500, 1}, {SamplingMode::Guided, true, 5, 0}});
  window.add(SamplingMode::Uniform, true, 500);
  EXPECT_EQ(window.recent(), (std::vector<JudgedAttempt>{{SamplingMode::Guided, true, 5, 0}}));
}

TEST(AttemptWindow, ForgetsTheOldestOfEachArmByItself) {
  AttemptWindow window;
  window.add(SamplingMode::Control, true, 1);
  for (std::uint64_t i = 0; i < kJudgedAttemptsPerMode + 5; ++i)
    window.add(SamplingMode::Guided, true, 100 + i);
  ASSERT_EQ(window.recent().size(), kJudgedAttemptsPerMode + 1);
  EXPECT_EQ(window.recent()[0].sampling_mode, SamplingMode::Control);
  EXPECT_EQ(window.recent()[0].age, kJudgedAttemptsPerMode + 5);
  EXPECT_EQ(window.recent()[1].checks, 105U);
}

TEST(AttemptWindow, TakesNoMoreOfAnAdviceThanItKeeps) {
  std::vector<JudgedAttempt> recent(2 * kJudgedAttemptsPerMode, {SamplingMode::Guided, true, 1, 0});
  recent.back().checks = 2;
  const AttemptWindow window(recent);
  ASSERT_EQ(window.recent().size(), kJudgedAttemptsPerMode);
  EXPECT_EQ(window.recent().back().checks, 2U);
}

TEST(AttemptWindow, AgeEndsAtTheGreatestNumber) {
  constexpr std::uint32_t kOldest = std::numeric_limits<std::uint32_t>::max();
  AttemptWindow window({{SamplingMode::Control, true, 500, kOldest}});
  window.add(SamplingMode::Guided, true, 70);
  EXPECT_EQ(window.recent()[0].age, kOldest);
}

}  // namespace
}  // namespace kinship::evidence::attempt_window_test
