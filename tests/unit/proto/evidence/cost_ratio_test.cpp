#include "proto/evidence/cost_ratio.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "proto/evidence/attempt_window.hpp"

namespace kinship::evidence::cost_ratio_test {
namespace {

constexpr double kCap = 100'000;

/// Attempts of a planner that needs about `typical` checks and gives up at the cap.
void add_attempts(AttemptWindow& window, SamplingMode mode, int count, double typical,
                  std::mt19937_64& generator) {
  std::lognormal_distribution<double> checks(std::log(typical), 0.7);
  for (int i = 0; i < count; ++i) {
    const double needed = checks(generator);
    window.add(mode, needed <= kCap, static_cast<std::uint64_t>(std::min(needed, kCap)));
  }
}

/// Modes in turn, as far as there are attempts of both.
AttemptWindow even_attempts(int guided, std::uint64_t guided_checks, int control,
                            std::uint64_t control_checks) {
  AttemptWindow window;
  for (int i = 0; i < std::max(guided, control); ++i) {
    if (i < guided)
      window.add(SamplingMode::Guided, true, guided_checks);
    if (i < control)
      window.add(SamplingMode::Control, true, control_checks);
  }
  return window;
}

double probability(const AttemptWindow& window) {
  return compare_costs(window.recent()).guided_is_cheaper;
}

std::vector<JudgedAttempt> scaled(std::vector<JudgedAttempt> recent, SamplingMode mode,
                                  std::uint64_t factor) {
  for (JudgedAttempt& attempt : recent)
    if (attempt.sampling_mode == mode)
      attempt.checks *= factor;
  return recent;
}

TEST(CostRatio, WithoutAttemptsOfBothArmsItIsThePrior) {
  const CostRatio prior = compare_costs({});
  EXPECT_FALSE(prior.is_compared);
  EXPECT_NEAR(prior.quantile(0), 1 / 0.7, 1e-4);
  EXPECT_NEAR(prior.guided_is_cheaper, 0.6393, 1e-3);
  EXPECT_EQ(probability(even_attempts(50, 100, 0, 0)), prior.guided_is_cheaper);
  EXPECT_EQ(probability(even_attempts(0, 0, 50, 100)), prior.guided_is_cheaper);
}

TEST(CostRatio, AttemptsThatReportNoChecksCompareNothing) {
  EXPECT_FALSE(compare_costs(even_attempts(20, 0, 20, 100).recent()).is_compared);
  EXPECT_FALSE(compare_costs(even_attempts(20, 100, 20, 0).recent()).is_compared);
}

/// Modes in turn, each attempt with these checks and this time.
AttemptWindow timed_attempts(int count, std::uint64_t guided_checks, double guided_s,
                             std::uint64_t control_checks, double control_s) {
  AttemptWindow window;
  for (int i = 0; i < count; ++i) {
    window.add(SamplingMode::Guided, true, guided_checks, guided_s);
    window.add(SamplingMode::Control, true, control_checks, control_s);
  }
  return window;
}

TEST(CostRatio, GuidanceThatSavesChecksButTakesLongerIsDearer) {
  const CostRatio ratio = compare_costs(timed_attempts(40, 500, 2e-3, 1000, 1e-3).recent());
  EXPECT_TRUE(ratio.is_by_time);
  EXPECT_NEAR(ratio.quantile(0), 0.5, 0.05);
  EXPECT_LT(ratio.guided_is_cheaper, 0.01);
}

TEST(CostRatio, GuidanceThatNeedsMoreChecksButLessTimeIsCheaper) {
  const CostRatio ratio = compare_costs(timed_attempts(40, 1000, 1e-3, 500, 2e-3).recent());
  EXPECT_NEAR(ratio.quantile(0), 2, 0.1);
  EXPECT_GT(ratio.guided_is_cheaper, 0.99);
}

TEST(CostRatio, ATimeWithoutChecksIsACost) {
  EXPECT_TRUE(compare_costs(timed_attempts(12, 0, 1e-3, 500, 2e-3).recent()).is_by_time);
}

TEST(CostRatio, ChecksAreComparedUntilTenAttemptsOfEachModeHaveATime) {
  AttemptWindow window = even_attempts(40, 500, 40, 1000);
  const auto add_timed = [&window] {
    window.add(SamplingMode::Guided, true, 500, 2e-3);
    window.add(SamplingMode::Control, true, 1000, 1e-3);
  };
  for (std::size_t i = 1; i < kMinTimed; ++i)
    add_timed();
  EXPECT_FALSE(compare_costs(window.recent()).is_by_time);
  EXPECT_GT(probability(window), 0.99);
  add_timed();
  EXPECT_TRUE(compare_costs(window.recent()).is_by_time);
  EXPECT_LT(probability(window), 0.5);
}

TEST(CostRatio, OneTimedModeAloneIsComparedByChecks) {
  AttemptWindow window;
  for (int i = 0; i < 30; ++i) {
    window.add(SamplingMode::Guided, true, 500, 2e-3);
    window.add(SamplingMode::Control, true, 1000);
  }
  EXPECT_FALSE(compare_costs(window.recent()).is_by_time);
  EXPECT_NEAR(compare_costs(window.recent()).quantile(0), 2, 0.1);
}

TEST(CostRatio, TheMedianComesToTheRatioOfTheCosts) {
  const CostRatio ratio = compare_costs(even_attempts(60, 1000, 60, 3000).recent());
  EXPECT_NEAR(ratio.quantile(0), 3, 0.1) << "uniform / guided";
  EXPECT_LT(ratio.quantile(-1.6449), 3);
  EXPECT_GT(ratio.quantile(1.6449), 3);
  EXPECT_GT(ratio.guided_is_cheaper, 1 - 1e-9);
  EXPECT_LT(probability(even_attempts(60, 3000, 60, 1000)), 1e-9);
}

TEST(CostRatio, UnsolvedAttemptsMakeAnArmDearer) {
  AttemptWindow window;
  for (int i = 0; i < 60; ++i) {
    window.add(SamplingMode::Guided, i % 2 == 0, 1000);
    window.add(SamplingMode::Control, true, 1000);
  }
  EXPECT_GT(compare_costs(window.recent()).quantile(0), 0.3);
  EXPECT_LT(compare_costs(window.recent()).quantile(0), 0.9);
}

TEST(CostRatio, AnArmThatSolvedNothingIsNoBargain) {
  AttemptWindow window;
  for (int i = 0; i < 30; ++i) {
    window.add(SamplingMode::Guided, false, 1000);
    window.add(SamplingMode::Control, true, 1000);
  }
  EXPECT_LT(probability(window), 0.05);
}

TEST(CostRatio, HowFastAPlannerChecksDoesNotMatter) {
  std::mt19937_64 generator(1);
  AttemptWindow window;
  add_attempts(window, SamplingMode::Guided, 12, 3000, generator);
  add_attempts(window, SamplingMode::Control, 7, 2500, generator);
  const auto faster =
      scaled(scaled(window.recent(), SamplingMode::Guided, 1000), SamplingMode::Control, 1000);
  EXPECT_NEAR(compare_costs(faster).mean, compare_costs(window.recent()).mean, 1e-9);
  EXPECT_NEAR(compare_costs(faster).variance, compare_costs(window.recent()).variance, 1e-9);
}

TEST(CostRatio, DearerGuidanceNeverLooksCheaper) {
  std::mt19937_64 generator(2);
  for (int run = 0; run < 100; ++run) {
    AttemptWindow window;
    for (int i = 0; i <= run % 20; ++i) {
      add_attempts(window, SamplingMode::Guided, 1, 3000, generator);
      add_attempts(window, SamplingMode::Control, 1, 2500, generator);
    }
    double before = 1;
    for (std::uint64_t factor = 1; factor < 100; factor *= 3) {
      const double now =
          compare_costs(scaled(window.recent(), SamplingMode::Guided, factor)).guided_is_cheaper;
      ASSERT_LE(now, before + 1e-12);
      before = now;
    }
  }
}

TEST(CostRatio, IsFiniteWhateverIsReported) {
  std::mt19937_64 generator(3);
  std::uniform_int_distribution<int> magnitude(0, 63), mode(0, 1), count(0, 100);
  std::bernoulli_distribution solved(0.5);
  for (int run = 0; run < 500; ++run) {
    AttemptWindow window;
    for (int i = count(generator); i > 0; --i)
      window.add(mode(generator) == 0 ? SamplingMode::Guided : SamplingMode::Control,
                 solved(generator), (std::uint64_t{1} << magnitude(generator)) - 1);
    const CostRatio ratio = compare_costs(window.recent());
    ASSERT_TRUE(std::isfinite(ratio.mean));
    ASSERT_TRUE(std::isfinite(ratio.variance));
    ASSERT_GT(ratio.variance, 0);
  }
}

TEST(CostRatio, OldAttemptsWeighLess) {
  const auto aged = [](std::uint32_t by) {
    std::vector<JudgedAttempt> recent = even_attempts(20, 1000, 20, 2000).recent();
    for (JudgedAttempt& attempt : recent)
      attempt.age += by;
    return compare_costs(recent);
  };
  EXPECT_LT(aged(0).variance, aged(400).variance);
  EXPECT_LT(aged(400).variance, aged(4000).variance);
  EXPECT_NEAR(aged(100'000).quantile(0), 1 / 0.7, 0.01) << "as if there were none";
}

/// The checks of an attempt that gave up say that more were needed, not that so many were.
TEST(CostRatio, GivingUpEarlyIsNoBargain) {
  AttemptWindow window;
  for (int i = 0; i < 60; ++i) {
    window.add(SamplingMode::Guided, i % 3 == 0, i % 3 == 0 ? 1500 : 1200);
    window.add(SamplingMode::Control, true, 1500);
  }
  EXPECT_LT(probability(window), 0.05);
}

TEST(CostRatio, OneAbsurdReportOfEitherModeChangesNothing) {
  std::mt19937_64 generator(7);
  AttemptWindow window;
  for (int i = 0; i < 50; ++i) {
    add_attempts(window, SamplingMode::Guided, 1, 1500, generator);
    add_attempts(window, SamplingMode::Control, 1, 2500, generator);
  }
  const CostRatio before = compare_costs(window.recent());
  ASSERT_GT(before.guided_is_cheaper, 0.95);
  for (const SamplingMode mode : {SamplingMode::Guided, SamplingMode::Control})
    for (const std::uint64_t checks :
         {std::uint64_t{1}, std::uint64_t{9'000'000'000'000'000'000}}) {
      AttemptWindow more = window;
      more.add(mode, true, checks);
      const CostRatio after = compare_costs(more.recent());
      EXPECT_NEAR(after.mean, before.mean, 0.1) << checks;
      EXPECT_GT(after.guided_is_cheaper, 0.95) << checks;
    }
}

TEST(CostRatio, NorDoesOneThatComesFirst) {
  std::mt19937_64 generator(9);
  AttemptWindow sane, absurd;
  absurd.add(SamplingMode::Guided, true, 9'000'000'000'000'000'000);
  sane.add(SamplingMode::Guided, true, 1500);
  for (int i = 0; i < 12; ++i)
    for (const SamplingMode mode : {SamplingMode::Control, SamplingMode::Guided}) {
      AttemptWindow one;
      add_attempts(one, mode, 1, mode == SamplingMode::Guided ? 1500 : 2500, generator);
      for (AttemptWindow* window : {&sane, &absurd})
        window->add(mode, true, one.recent()[0].checks);
    }
  EXPECT_NEAR(compare_costs(absurd.recent()).mean, compare_costs(sane.recent()).mean, 0.2);
}

/// Where nobody tries the other mode any more, a change of guidance looks as one of the task does.
/// It has to raise doubt, so that the other mode is tried again.
TEST(CostRatio, AChangeInOneModeRaisesDoubt) {
  std::mt19937_64 generator(8);
  AttemptWindow window;
  for (int i = 0; i < 20; ++i) {
    add_attempts(window, SamplingMode::Control, 1, 5000, generator);
    add_attempts(window, SamplingMode::Guided, 3, 1500, generator);
  }
  const double before = compare_costs(window.recent()).variance;
  add_attempts(window, SamplingMode::Guided, 10, 15'000, generator);
  EXPECT_GT(compare_costs(window.recent()).variance, 1.5 * before);
  for (int i = 0; i < 10; ++i) {
    add_attempts(window, SamplingMode::Control, 1, 5000, generator);
    add_attempts(window, SamplingMode::Guided, 1, 15'000, generator);
  }
  EXPECT_LT(probability(window), 0.5) << "and ten of the other settle it";
}

/// The probability is worth its name if guidance that makes no difference is called cheaper with
/// 95 % and dearer with 95 % in few cases each.
TEST(CostRatio, EqualCostsAreSeldomCalledClearlyDifferent) {
  constexpr int kRuns = 2000;
  int better = 0, worse = 0;
  std::mt19937_64 generator(5);
  for (int i = 0; i < kRuns; ++i) {
    AttemptWindow window;
    for (int attempt = 0; attempt < 30; ++attempt) {
      add_attempts(window, SamplingMode::Control, 1, 5000, generator);
      add_attempts(window, SamplingMode::Guided, 1, 5000, generator);
    }
    better += probability(window) > 0.95 ? 1 : 0;
    worse += probability(window) < 0.05 ? 1 : 0;
  }
  EXPECT_LT(better, kRuns / 10);
  EXPECT_LT(worse, kRuns / 10);
  EXPECT_GT(better + worse, kRuns / 50);
}

}  // namespace
}  // namespace kinship::evidence::cost_ratio_test
