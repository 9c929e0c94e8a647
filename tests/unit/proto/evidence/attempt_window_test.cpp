#include "proto/evidence/attempt_window.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace kinship::evidence::attempt_window_test {
namespace {

TEST(AttemptWindow, AddedAttemptsMakeTheOthersOlder) {
  AttemptWindow window({{Arm::Control, true, 500, 3}, {Arm::Guided, false, 900, 0}});
  window.add(Arm::Guided, true, 70);
  EXPECT_EQ(window.recent(), (std::vector<JudgedAttempt>{{Arm::Control, true, 500, 4},
                                                         {Arm::Guided, false, 900, 1},
                                                         {Arm::Guided, true, 70, 0}}));
}

TEST(AttemptWindow, UniformAttemptsAreNoEvidence) {
  AttemptWindow window({{Arm::Uniform, true, 500, 1}, {Arm::Guided, true, 5, 0}});
  window.add(Arm::Uniform, true, 500);
  EXPECT_EQ(window.recent(), (std::vector<JudgedAttempt>{{Arm::Guided, true, 5, 0}}));
}

TEST(AttemptWindow, ForgetsTheOldestOfEachArmByItself) {
  AttemptWindow window;
  window.add(Arm::Control, true, 1);
  for (std::uint64_t i = 0; i < kJudgedAttemptsPerArm + 5; ++i)
    window.add(Arm::Guided, true, 100 + i);
  ASSERT_EQ(window.recent().size(), kJudgedAttemptsPerArm + 1);
  EXPECT_EQ(window.recent()[0].arm, Arm::Control);
  EXPECT_EQ(window.recent()[0].age, kJudgedAttemptsPerArm + 5);
  EXPECT_EQ(window.recent()[1].checks, 105U);
}

TEST(AttemptWindow, TakesNoMoreOfAnAdviceThanItKeeps) {
  std::vector<JudgedAttempt> recent(2 * kJudgedAttemptsPerArm, {Arm::Guided, true, 1, 0});
  recent.back().checks = 2;
  const AttemptWindow window(recent);
  ASSERT_EQ(window.recent().size(), kJudgedAttemptsPerArm);
  EXPECT_EQ(window.recent().back().checks, 2U);
}

TEST(AttemptWindow, AgeEndsAtTheGreatestNumber) {
  constexpr std::uint32_t kOldest = std::numeric_limits<std::uint32_t>::max();
  AttemptWindow window({{Arm::Control, true, 500, kOldest}});
  window.add(Arm::Guided, true, 70);
  EXPECT_EQ(window.recent()[0].age, kOldest);
}

}  // namespace
}  // namespace kinship::evidence::attempt_window_test
