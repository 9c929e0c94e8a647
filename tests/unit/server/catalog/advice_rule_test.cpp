#include "server/catalog/advice_rule.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "proto/evidence/attempt_window.hpp"

namespace kinship::catalog::advice_rule_test {
namespace {

constexpr double kProfileShare = 0.9;

/// Attempts of one context as the store sums them up.
class Ledger {
 public:
  Ledger& add(SamplingMode mode, int count, double checks, int solved, double time_s = 0) {
    store::ModeTotals& totals = mode == SamplingMode::Guided ? totals_.guided : totals_.control;
    for (int i = 0; i < count; ++i) {
      ++totals.attempts;
      ++(mode == SamplingMode::Guided ? judged_.guided : judged_.control);
      totals.solved += i < solved ? 1 : 0;
      totals.checks += checks;
      window_.add(mode, i < solved, static_cast<std::uint64_t>(checks), time_s);
    }
    judged_.attempts = window_.recent();
    return *this;
  }
  Ledger& add(SamplingMode mode, int count, double checks) {
    return add(mode, count, checks, count);
  }
  const JudgedAttempts& judged() const { return judged_; }
  Advice advice() const { return advise(totals_, judged_, kProfileShare); }

 private:
  store::AttemptTotals totals_;
  JudgedAttempts judged_;
  evidence::AttemptWindow window_;
};

TEST(AdviceRule, WithoutAttemptsTheProfileDecides) {
  const Advice advice = Ledger().advice();
  EXPECT_EQ(advice.recommended_share, kProfileShare);
  EXPECT_EQ(advice.guided_share, kProfileShare);
  EXPECT_FALSE(advice.guided);
  EXPECT_FALSE(advice.control);
  EXPECT_TRUE(advice.recent.empty());
  EXPECT_EQ(
      advice.evidence,
      "default; a measured one needs 10 guided and 10 control attempts with this profile and these "
      "engines, there are 0 and 0");
}

TEST(AdviceRule, NineAttemptsOfAnArmDecideNothingYet) {
  EXPECT_EQ(Ledger()
                .add(SamplingMode::Guided, 60, 9e6)
                .add(SamplingMode::Control, 9, 10)
                .advice()
                .recommended_share,
            kProfileShare);
  EXPECT_EQ(Ledger()
                .add(SamplingMode::Guided, 60, 9e6)
                .add(SamplingMode::Control, 10, 10)
                .advice()
                .recommended_share,
            0);
}

TEST(AdviceRule, WhoSamplesPerQueryGetsTheAttemptsAndTheProfilesShare) {
  const Ledger ledger =
      Ledger().add(SamplingMode::Guided, 60, 9e6).add(SamplingMode::Control, 10, 10);
  EXPECT_EQ(ledger.advice().guided_share, kProfileShare);
  EXPECT_EQ(ledger.advice().recent, ledger.judged().attempts);
}

TEST(AdviceRule, EvidenceNamesCostsAttemptsRatioAndInterval) {
  const Advice better =
      Ledger().add(SamplingMode::Control, 12, 6904).add(SamplingMode::Guided, 40, 2000).advice();
  EXPECT_EQ(better.recommended_share, kProfileShare);
  EXPECT_EQ(better.evidence.find("guided 2000 checks per solution in 40 attempts, control 6904 in "
                                 "12; typical ratio uniform / guided "),
            0U)
      << better.evidence;
  EXPECT_NE(better.evidence.find("better: share of the profile"), std::string::npos);
  EXPECT_EQ(*better.guided, (ModeEvidence{40, 40, 2000}));
  EXPECT_EQ(*better.control, (ModeEvidence{12, 12, 6904}));
  const Advice worse =
      Ledger().add(SamplingMode::Control, 12, 2000).add(SamplingMode::Guided, 40, 6904).advice();
  EXPECT_EQ(worse.recommended_share, 0);
  EXPECT_NE(worse.evidence.find("worse: uniform"), std::string::npos) << worse.evidence;
}

TEST(AdviceRule, GuidanceThatNeedsFewerChecksButMoreTimeIsNotAdvised) {
  const Advice advice = Ledger()
                            .add(SamplingMode::Control, 30, 2000, 30, 1e-3)
                            .add(SamplingMode::Guided, 30, 500, 30, 3e-3)
                            .advice();
  EXPECT_EQ(advice.recommended_share, 0);
  EXPECT_NE(advice.evidence.find("guided 500 checks per solution in 30 attempts, control 2000 in "
                                 "30; by processor time, typical ratio uniform / guided 0.3"),
            std::string::npos)
      << advice.evidence;
  EXPECT_EQ(Ledger()
                .add(SamplingMode::Control, 30, 500, 30, 3e-3)
                .add(SamplingMode::Guided, 30, 2000, 30, 1e-3)
                .advice()
                .recommended_share,
            kProfileShare)
      << "and the other way round";
}

TEST(AdviceRule, AttemptsFromBeforeTimesWereReportedAreComparedByChecks) {
  EXPECT_EQ(Ledger()
                .add(SamplingMode::Control, 30, 2000)
                .add(SamplingMode::Guided, 30, 500)
                .add(SamplingMode::Guided, 5, 500, 5, 3e-3)
                .add(SamplingMode::Control, 5, 2000, 5, 1e-3)
                .advice()
                .recommended_share,
            kProfileShare);
}

TEST(AdviceRule, AnArmThatSolvedNothingIsNamedAndCostsMore) {
  const Advice advice =
      Ledger().add(SamplingMode::Guided, 30, 1000, 0).add(SamplingMode::Control, 30, 1000).advice();
  EXPECT_EQ(advice.recommended_share, 0);
  EXPECT_EQ(advice.guided->checks_per_solution, 0);
  EXPECT_NE(advice.evidence.find("guided none solved in 30"), std::string::npos) << advice.evidence;
}

TEST(AdviceRule, WithoutChecksThereIsNothingToCompare) {
  const Advice advice =
      Ledger().add(SamplingMode::Guided, 30, 0).add(SamplingMode::Control, 30, 1000).advice();
  EXPECT_EQ(advice.recommended_share, kProfileShare);
  EXPECT_NE(advice.evidence.find("report processor time or collision checks"), std::string::npos)
      << advice.evidence;
}

TEST(AdviceRule, ShareMovesWithoutAJumpAndNeverUpAsGuidanceGetsDearer) {
  double before = kProfileShare;
  bool was_between = false;
  for (double checks = 1000; checks < 30'000; checks *= 1.005) {
    Ledger ledger;
    for (int i = 0; i < 15; ++i)
      ledger.add(SamplingMode::Guided, 2, checks).add(SamplingMode::Control, 1, 5000);
    const double share = ledger.advice().recommended_share;
    EXPECT_LE(share, before + 1e-9) << checks;
    EXPECT_NEAR(share, before, 0.1) << checks;
    was_between = was_between || (share > 0.3 && share < 0.6);
    before = share;
  }
  EXPECT_TRUE(was_between);
  EXPECT_EQ(before, 0);
}

}  // namespace
}  // namespace kinship::catalog::advice_rule_test
