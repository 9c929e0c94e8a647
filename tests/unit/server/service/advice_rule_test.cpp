#include "server/service/advice_rule.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace kinship::service {
namespace {

constexpr double kProfileShare = 0.9;

void add(store::ArmTotals& arm, double checks, bool solved) {
  ++arm.attempts;
  arm.solved += solved ? 1 : 0;
  arm.checks += checks;
  arm.checks_squared += checks * checks;
  arm.checks_of_solved += solved ? checks : 0;
}

/// Attempts of a planner that needs about `typical` checks and gives up at `most`.
store::ArmTotals simulated(int attempts, double typical, double most, std::mt19937_64& generator) {
  std::lognormal_distribution<double> checks(std::log(typical), 0.7);
  store::ArmTotals arm;
  for (int i = 0; i < attempts; ++i) {
    const double needed = checks(generator);
    add(arm, std::min(needed, most), needed <= most);
  }
  return arm;
}

/// Whatever an arm may sum up to, also nothing, and numbers at the end of their range.
store::ArmTotals random_arm(std::mt19937_64& generator) {
  std::uniform_int_distribution<int> kind(0, 5), count(0, 40);
  const double unit = std::pow(10.0, kind(generator) * 3.5);
  std::exponential_distribution<double> checks(1);
  std::bernoulli_distribution solved(0.2 * kind(generator));
  store::ArmTotals arm;
  const int attempts = count(generator);
  for (int i = 0; i < attempts; ++i)
    add(arm, kind(generator) == 0 ? 0 : std::floor(unit * checks(generator)), solved(generator));
  return arm;
}

store::AttemptTotals scaled(store::AttemptTotals totals, double guided, double control) {
  const auto scale = [](store::ArmTotals& arm, double factor) {
    arm.checks *= factor;
    arm.checks_squared *= factor * factor;
    arm.checks_of_solved *= factor;
  };
  scale(totals.guided, guided);
  scale(totals.control, control);
  return totals;
}

store::ArmTotals equal_attempts(int attempts, int solved, double checks) {
  store::ArmTotals arm;
  for (int i = 0; i < attempts; ++i)
    add(arm, checks, i < solved);
  return arm;
}

TEST(AdviceRule, WithoutAttemptsTheProfileDecides) {
  const Advice advice = advise({}, kProfileShare);
  EXPECT_EQ(advice.recommended_share, kProfileShare);
  EXPECT_FALSE(advice.guided);
  EXPECT_FALSE(advice.control);
  EXPECT_EQ(advice.evidence,
            "0 guided and 0 control attempts, compared from 10 of each on: share of the profile");
}

TEST(AdviceRule, NineAttemptsOfAnArmTeachNothingYet) {
  const store::AttemptTotals totals{equal_attempts(1000, 1000, 9e6), equal_attempts(9, 9, 10)};
  EXPECT_EQ(advise(totals, kProfileShare).recommended_share, kProfileShare);
  const store::AttemptTotals ten{equal_attempts(1000, 1000, 9e6), equal_attempts(10, 10, 10)};
  EXPECT_EQ(advise(ten, kProfileShare).recommended_share, 0);
}

TEST(AdviceRule, EvidenceNamesCostsAttemptsRatioAndInterval) {
  store::AttemptTotals totals{equal_attempts(40, 40, 4120), equal_attempts(12, 12, 6904)};
  const Advice better = advise(totals, kProfileShare);
  EXPECT_EQ(better.recommended_share, kProfileShare);
  EXPECT_EQ(better.evidence,
            "guided 4120 checks per solution in 40 attempts, control 6904 in 12: ratio 0.60 "
            "(90 % 0.60 to 0.60), clearly better: share of the profile");
  ASSERT_TRUE(better.guided && better.control);
  EXPECT_EQ(*better.guided, (ArmEvidence{40, 40, 4120}));
  EXPECT_EQ(*better.control, (ArmEvidence{12, 12, 6904}));
  std::swap(totals.guided, totals.control);
  const Advice worse = advise(totals, kProfileShare);
  EXPECT_EQ(worse.recommended_share, 0);
  EXPECT_NE(worse.evidence.find("clearly worse: uniform"), std::string::npos) << worse.evidence;
}

TEST(AdviceRule, UnsolvedAttemptsMakeAnArmDearer) {
  const Advice advice =
      advise({equal_attempts(20, 10, 1000), equal_attempts(20, 20, 1000)}, kProfileShare);
  EXPECT_EQ(advice.guided->checks_per_solution, 2000);
  EXPECT_EQ(advice.control->checks_per_solution, 1000);
  EXPECT_EQ(advice.recommended_share, 0);
}

TEST(AdviceRule, AnArmThatSolvedNothingCountsAsHalfASolution) {
  const Advice guided_never =
      advise({equal_attempts(30, 0, 1000), equal_attempts(30, 30, 1000)}, kProfileShare);
  EXPECT_EQ(guided_never.recommended_share, 0);
  EXPECT_EQ(guided_never.guided->checks_per_solution, 0);
  EXPECT_NE(guided_never.evidence.find("guided none solved in 30"), std::string::npos)
      << guided_never.evidence;
  const Advice control_never =
      advise({equal_attempts(30, 30, 1000), equal_attempts(30, 0, 1000)}, kProfileShare);
  EXPECT_EQ(control_never.recommended_share, kProfileShare);
  const Advice neither =
      advise({equal_attempts(30, 0, 1000), equal_attempts(30, 0, 1000)}, kProfileShare);
  EXPECT_NEAR(neither.recommended_share, kProfileShare / 2, 1e-9);
}

TEST(AdviceRule, WithoutChecksThereIsNothingToCompare) {
  const Advice advice =
      advise({equal_attempts(30, 30, 0), equal_attempts(30, 30, 1000)}, kProfileShare);
  EXPECT_EQ(advice.recommended_share, kProfileShare);
  EXPECT_NE(advice.evidence.find("guided attempts report no collision checks"), std::string::npos);
}

TEST(AdviceRule, ShareIsANumberBetweenZeroAndTheProfiles) {
  std::mt19937_64 generator(1);
  for (int i = 0; i < 5000; ++i) {
    const store::AttemptTotals totals{random_arm(generator), random_arm(generator)};
    const Advice advice = advise(totals, kProfileShare);
    ASSERT_TRUE(std::isfinite(advice.recommended_share)) << advice.evidence;
    ASSERT_GE(advice.recommended_share, 0) << advice.evidence;
    ASSERT_LE(advice.recommended_share, kProfileShare) << advice.evidence;
    ASSERT_EQ(advice.evidence.find("nan"), std::string::npos) << advice.evidence;
    ASSERT_LE(advice.evidence.size(), 512U);
  }
}

TEST(AdviceRule, HowFastThePlannerChecksDoesNotMatter) {
  std::mt19937_64 generator(2);
  for (int i = 0; i < 1000; ++i) {
    const store::AttemptTotals totals{random_arm(generator), random_arm(generator)};
    const double share = advise(totals, kProfileShare).recommended_share;
    ASSERT_NEAR(advise(scaled(totals, 1e3, 1e3), kProfileShare).recommended_share, share, 1e-6);
    ASSERT_NEAR(advise(scaled(totals, 1e-3, 1e-3), kProfileShare).recommended_share, share, 1e-6);
  }
}

TEST(AdviceRule, DearerGuidanceIsNeverRecommendedMore) {
  std::mt19937_64 generator(3);
  for (int i = 0; i < 300; ++i) {
    const store::AttemptTotals totals{random_arm(generator), random_arm(generator)};
    double before = kProfileShare;
    for (double factor = 1e-3; factor < 1e3; factor *= 1.3) {
      const double share = advise(scaled(totals, factor, 1), kProfileShare).recommended_share;
      ASSERT_LE(share, before + 1e-9) << "factor " << factor;
      before = share;
    }
  }
}

TEST(AdviceRule, ShareMovesWithoutAJump) {
  std::mt19937_64 generator(4);
  const store::AttemptTotals totals{simulated(50, 5000, 30'000, generator),
                                    simulated(15, 5000, 30'000, generator)};
  double before = kProfileShare;
  bool was_between = false;
  for (double factor = 0.2; factor < 5; factor *= 1.005) {
    const double share = advise(scaled(totals, factor, 1), kProfileShare).recommended_share;
    EXPECT_NEAR(share, before, 0.02) << "factor " << factor;
    was_between = was_between || (share > 0.3 && share < 0.6);
    before = share;
  }
  EXPECT_TRUE(was_between);
  EXPECT_EQ(before, 0);
}

/// The interval is worth its name if guidance that makes no difference is called clearly better
/// and clearly worse in about 5 % of the cases each.
TEST(AdviceRule, TheIntervalHoldsWhatItPromises) {
  std::mt19937_64 generator(5);
  constexpr int kRuns = 4000;
  int better = 0, worse = 0;
  for (int i = 0; i < kRuns; ++i) {
    const double share =
        advise({simulated(60, 5000, 20'000, generator), simulated(30, 5000, 20'000, generator)},
               kProfileShare)
            .recommended_share;
    better += share == kProfileShare ? 1 : 0;
    worse += share == 0 ? 1 : 0;
  }
  EXPECT_GT(better, kRuns / 40);
  EXPECT_LT(better, kRuns / 10);
  EXPECT_GT(worse, kRuns / 40);
  EXPECT_LT(worse, kRuns / 10);
}

/// A fleet that follows the advice, with a tenth of its attempts as control and, at share 0, a
/// tenth that try guidance all the same.
double share_after(int attempts, double guided_checks, double uniform_checks, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::bernoulli_distribution tenth(0.1);
  store::AttemptTotals totals;
  double share = kProfileShare;
  for (int i = 0; i < attempts; ++i) {
    const bool guided = share > 0 ? !tenth(generator) : tenth(generator);
    const store::ArmTotals one =
        simulated(1, guided ? guided_checks : uniform_checks, 40'000, generator);
    add(guided ? totals.guided : totals.control, one.checks, one.solved > 0);
    share = advise(totals, kProfileShare).recommended_share;
  }
  return share;
}

TEST(AdviceRule, AFleetGivesUpWorseGuidanceAndKeepsBetterOne) {
  int given_up = 0, kept = 0;
  constexpr int kFleets = 20;
  for (unsigned seed = 0; seed < kFleets; ++seed) {
    given_up += share_after(400, 10'000, 5000, seed) == 0 ? 1 : 0;
    kept += share_after(400, 2500, 5000, seed) == kProfileShare ? 1 : 0;
  }
  EXPECT_GE(given_up, kFleets - 1);
  EXPECT_GE(kept, kFleets - 1);
}

}  // namespace
}  // namespace kinship::service
