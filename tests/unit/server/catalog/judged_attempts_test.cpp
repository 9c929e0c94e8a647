#include "server/catalog/judged_attempts.hpp"

#include <gtest/gtest.h>

#include "tests/support/store_values.hpp"

namespace kinship::catalog::judged_attempts_test {
namespace {

using store::KnownAttempt;

const Context kNow{"engines 2", "default"};
const Digest kServed = test::id_from<Digest>(1);
const Digest kOldEngines = test::id_from<Digest>(2);
const Digest kOtherProfile = test::id_from<Digest>(3);
const Digest kForgotten = test::id_from<Digest>(4);
const Contexts kContexts = {{kServed, kNow},
                            {kOldEngines, {"engines 1", "default"}},
                            {kOtherProfile, {"engines 2", "sharp"}}};

void add(std::vector<KnownAttempt>& known, int count, SamplingMode mode, std::uint64_t checks,
         const std::optional<Digest>& distribution, const std::string& planner = "birrt") {
  for (int i = 0; i < count; ++i)
    add_newest(known, {.judged = {.sampling_mode = mode, .solved = true, .checks = checks},
                       .planner = planner,
                       .distribution_id = distribution});
}

TEST(JudgedAttempts, ThoseOfTheContextCountWithTheirAge) {
  std::vector<KnownAttempt> known;
  add(known, 3, SamplingMode::Guided, 10, kServed);
  add(known, 2, SamplingMode::Control, 20, kServed);
  const JudgedAttempts judged = judged_attempts(kNow, kContexts, known);
  EXPECT_EQ(judged.guided, 3U);
  EXPECT_EQ(judged.control, 2U);
  EXPECT_EQ(judged.planner, "birrt");
  ASSERT_EQ(judged.attempts.size(), 5U);
  EXPECT_EQ(judged.attempts.front(), (JudgedAttempt{SamplingMode::Guided, true, 10, 4}));
  EXPECT_EQ(judged.attempts.back(), (JudgedAttempt{SamplingMode::Control, true, 20, 0}));
}

TEST(JudgedAttempts, ThoseOfOtherEnginesAndProfilesDoNotCount) {
  for (const Digest& other : {kOldEngines, kOtherProfile}) {
    std::vector<KnownAttempt> known;
    add(known, 9, SamplingMode::Guided, 30, other, "rrtc");
    add(known, 1, SamplingMode::Guided, 10, kServed);
    add(known, 1, SamplingMode::Guided, 30, other);
    const JudgedAttempts judged = judged_attempts(kNow, kContexts, known);
    EXPECT_EQ(judged.guided, 1U);
    EXPECT_EQ(judged.attempts, (std::vector<JudgedAttempt>{{SamplingMode::Guided, true, 10, 1}}));
  }
}

TEST(JudgedAttempts, UnknownOnesAreOldAndDoNotMakeUpTheNumber) {
  for (const std::optional<Digest>& other : {std::optional(kForgotten), std::optional<Digest>()}) {
    std::vector<KnownAttempt> known;
    add(known, 1, SamplingMode::Guided, 10, kServed);
    add(known, 1, SamplingMode::Guided, 30, other);
    const JudgedAttempts judged = judged_attempts(kNow, kContexts, known);
    EXPECT_EQ(judged.guided, 1U);
    ASSERT_EQ(judged.attempts.size(), 2U);
    EXPECT_EQ(judged.attempts[0], (JudgedAttempt{SamplingMode::Guided, true, 30, kAgeOfUnknown}));
    EXPECT_EQ(judged.attempts[1], (JudgedAttempt{SamplingMode::Guided, true, 10, 1}));
  }
}

TEST(JudgedAttempts, TwoPlannersAreNotCompared) {
  std::vector<KnownAttempt> known;
  add(known, 5, SamplingMode::Guided, 10, kServed, "birrt");
  add(known, 9, SamplingMode::Control, 99, kForgotten, "rrtc");
  const JudgedAttempts judged = judged_attempts(kNow, kContexts, known);
  EXPECT_EQ(judged.planner, "birrt") << "that of the context, although fewer";
  EXPECT_EQ(judged.attempts.size(), 5U);
  EXPECT_EQ(judged.control, 0U);
  add(known, 6, SamplingMode::Guided, 10, kServed, "rrtc");
  EXPECT_EQ(judged_attempts(kNow, kContexts, known).planner, "rrtc");
}

TEST(JudgedAttempts, NoMoreThanAreSent) {
  std::vector<KnownAttempt> known;
  add(known, static_cast<int>(kJudgedAttemptsPerMode) + 5, SamplingMode::Guided, 10, kServed);
  add(known, static_cast<int>(kJudgedAttemptsPerMode), SamplingMode::Guided, 30, kForgotten);
  const JudgedAttempts judged = judged_attempts(kNow, kContexts, known);
  ASSERT_EQ(judged.attempts.size(), kJudgedAttemptsPerMode);
  for (const JudgedAttempt& one : judged.attempts)
    EXPECT_EQ(one.checks, 10U) << "unknown ones make room";
}

TEST(JudgedAttempts, OfEachModeTheOldestAreForgottenByThemselves) {
  std::vector<KnownAttempt> known;
  add(known, 1, SamplingMode::Control, 20, kServed);
  add(known, static_cast<int>(store::kKnownAttemptsPerMode) + 3, SamplingMode::Guided, 10, kServed);
  ASSERT_EQ(known.size(), store::kKnownAttemptsPerMode + 1);
  EXPECT_EQ(known.front().judged.sampling_mode, SamplingMode::Control);
  EXPECT_EQ(known.front().judged.age, store::kKnownAttemptsPerMode + 3);
}

TEST(JudgedAttempts, NothingIsNothing) {
  EXPECT_TRUE(judged_attempts(kNow, kContexts, {}).attempts.empty());
}

}  // namespace
}  // namespace kinship::catalog::judged_attempts_test
