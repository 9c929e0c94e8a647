#include "proto/evidence/cost_ratio.hpp"

#include <gtest/gtest.h>

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

AttemptWindow even_attempts(int guided, std::uint64_t guided_checks, int control,
                            std::uint64_t control_checks) {
  AttemptWindow window;
  for (int i = 0; i < guided; ++i)
    window.add(SamplingMode::Guided, true, guided_checks);
  for (int i = 0; i < control; ++i)
    window.add(SamplingMode::Control, true, control_checks);
  return window;
}

double probability(const AttemptWindow& window) {
  return compare_costs(window.recent()).guided_is_cheaper();
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
  EXPECT_NEAR(prior.quantile(0), 0.7, 1e-4);
  EXPECT_NEAR(prior.guided_is_cheaper(), 0.6393, 1e-3);
  EXPECT_EQ(probability(even_attempts(50, 100, 0, 0)), prior.guided_is_cheaper());
  EXPECT_EQ(probability(even_attempts(0, 0, 50, 100)), prior.guided_is_cheaper());
}

TEST(CostRatio, AttemptsThatReportNoChecksCompareNothing) {
  EXPECT_FALSE(compare_costs(even_attempts(20, 0, 20, 100).recent()).is_compared);
  EXPECT_FALSE(compare_costs(even_attempts(20, 100, 20, 0).recent()).is_compared);
}

/// By hand: equal checks in each arm leave the prior spread alone, 4 / (weight + 4) / weight.
TEST(CostRatio, OneAttemptOfEachArmByHand) {
  AttemptWindow window = even_attempts(1, 2000, 1, 1000);
  const CostRatio ratio = compare_costs(window.recent());
  const double older = std::exp2(-1 / kHalfLifeInTask);
  const double variance = 4 / (older + 4) / older + 4.0 / 5;
  const double mean = (std::log(2.0) / variance + std::log(0.7)) / (1 / variance + 1);
  EXPECT_NEAR(ratio.mean, mean, 1e-5);
  EXPECT_NEAR(ratio.variance, 1 / (1 / variance + 1), 1e-12);
}

TEST(CostRatio, TheMedianComesToTheRatioOfTheCosts) {
  const CostRatio ratio = compare_costs(even_attempts(60, 3000, 60, 1000).recent());
  EXPECT_NEAR(ratio.quantile(0), 3, 0.05);
  EXPECT_LT(ratio.quantile(-1.6449), 3);
  EXPECT_GT(ratio.quantile(1.6449), 3);
  EXPECT_LT(ratio.guided_is_cheaper(), 1e-9);
}

TEST(CostRatio, UnsolvedAttemptsMakeAnArmDearer) {
  AttemptWindow window;
  for (int i = 0; i < 60; ++i) {
    window.add(SamplingMode::Guided, i % 2 == 0, 1000);
    window.add(SamplingMode::Control, true, 1000);
  }
  EXPECT_NEAR(compare_costs(window.recent()).quantile(0), 2, 0.1);
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
    add_attempts(window, SamplingMode::Guided, 1 + run % 20, 3000, generator);
    add_attempts(window, SamplingMode::Control, 1 + run % 13, 2500, generator);
    double before = 1;
    for (std::uint64_t factor = 1; factor < 10'000; factor *= 3) {
      const double now =
          compare_costs(scaled(window.recent(), SamplingMode::Guided, factor)).guided_is_cheaper();
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

TEST(CostRatio, AnAttemptWeighsHalfAfterAHalfLife) {
  // Two guided attempts of 1000 and 4000 checks: how far towards the newer one the cost lies says
  // how much the older one weighs.
  const auto cost_of_guided = [](std::uint32_t newer_in_task, int newer_in_mode) {
    std::vector<JudgedAttempt> recent = {{SamplingMode::Guided, true, 1000, newer_in_task}};
    for (int i = 0; i < newer_in_mode; ++i)
      recent.push_back({SamplingMode::Guided, true, 4000, 0});
    const std::vector<JudgedAttempt> control(2000, {SamplingMode::Control, true, 4000, 0});
    recent.insert(recent.end(), control.begin(), control.end());
    const CostRatio ratio = compare_costs(recent);
    // Undo the prior: mean = (d / v + m0) / (1 / v + 1).
    const double precision = 1 / ratio.variance - 1;
    return 4000 * std::exp((ratio.mean / ratio.variance - std::log(0.7)) / precision);
  };
  const auto expected = [](double older, double newer) {
    return (older * 1000 + newer * 4000) / (older + newer);
  };
  const double one = std::exp2(-1 / kHalfLifeInMode);
  EXPECT_NEAR(cost_of_guided(0, 1), expected(one, 1), 5);
  EXPECT_NEAR(cost_of_guided(static_cast<std::uint32_t>(kHalfLifeInTask), 1), expected(one / 2, 1),
              5);
}

TEST(CostRatio, AChangeForTheWorseIsBelievedAfterFewAttempts) {
  int found = 0;
  constexpr int kRuns = 40, kNew = 6;
  for (unsigned run = 0; run < kRuns; ++run) {
    std::mt19937_64 generator(run);
    AttemptWindow window;
    add_attempts(window, SamplingMode::Control, 20, 5000, generator);
    add_attempts(window, SamplingMode::Guided, 60, 1500, generator);
    EXPECT_GT(probability(window), 0.9);
    add_attempts(window, SamplingMode::Guided, kNew, 15'000, generator);
    found += probability(window) < 0.5 ? 1 : 0;
  }
  EXPECT_GE(found, kRuns * 3 / 4);
}

TEST(CostRatio, SteadyTasksKeepTheirBelief) {
  int kept = 0;
  constexpr int kRuns = 100;
  for (unsigned run = 0; run < kRuns; ++run) {
    std::mt19937_64 generator(1000 + run);
    AttemptWindow window;
    add_attempts(window, SamplingMode::Control, 20, 5000, generator);
    add_attempts(window, SamplingMode::Guided, 64, 1500, generator);
    kept += probability(window) > 0.95 ? 1 : 0;
  }
  EXPECT_GE(kept, kRuns * 9 / 10);
}

/// The probability is worth its name if guidance that makes no difference is called cheaper with
/// 95 % and dearer with 95 % in few cases each.
TEST(CostRatio, EqualCostsAreSeldomCalledClearlyDifferent) {
  constexpr int kRuns = 2000;
  int better = 0, worse = 0;
  std::mt19937_64 generator(5);
  for (int i = 0; i < kRuns; ++i) {
    AttemptWindow window;
    add_attempts(window, SamplingMode::Control, 30, 5000, generator);
    add_attempts(window, SamplingMode::Guided, 30, 5000, generator);
    better += probability(window) > 0.95 ? 1 : 0;
    worse += probability(window) < 0.05 ? 1 : 0;
  }
  EXPECT_LT(better, kRuns / 10);
  EXPECT_LT(worse, kRuns / 10);
  EXPECT_GT(better + worse, kRuns / 50);
}

}  // namespace
}  // namespace kinship::evidence::cost_ratio_test
