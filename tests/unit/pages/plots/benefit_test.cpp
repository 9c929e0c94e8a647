#include "pages/plots/task_history.hpp"

#include <gtest/gtest.h>

#include "proto/evidence/attempt_window.hpp"
#include "proto/evidence/cost_ratio.hpp"
#include "tests/unit/pages/plots/history_values.hpp"

namespace kinship::plots::benefit_test {
namespace {

std::vector<Benefit> benefit_of(const std::vector<AttemptSummary>& attempts) {
  return history_of("shelf", attempts, {}).robots.front().benefit;
}

TEST(Benefit, BeginsWithTenAttemptsOfEitherMode) {
  EXPECT_TRUE(benefit_of(test::season(9, 100, 300)).empty());
  const auto benefit = benefit_of(test::season(10, 100, 300));
  ASSERT_EQ(benefit.size(), 1U);
  EXPECT_EQ(benefit[0].guided, 10U);
  EXPECT_EQ(benefit[0].control, 10U);
  EXPECT_EQ(benefit[0].time_ms, test::kNoon_ms + 20'000) << "the end of its bin";
}

TEST(Benefit, IsTheServersEstimate) {
  const std::vector<AttemptSummary> attempts = test::season(25, 100, 300);
  evidence::AttemptWindow window;
  for (const AttemptSummary& attempt : attempts)
    window.add(attempt.record.sampling_mode, true, attempt.record.collision_checks);
  const evidence::CostRatio ratio = evidence::compare_costs(window.recent());
  const Benefit last = benefit_of(attempts).back();
  EXPECT_DOUBLE_EQ(last.ratio, ratio.quantile(0));
  EXPECT_GT(last.ratio, 2);
  EXPECT_LT(last.low, last.ratio);
  EXPECT_GT(last.high, last.ratio);
  EXPECT_DOUBLE_EQ(last.low, ratio.quantile(-1.6449));
}

TEST(Benefit, GetsFirmerWithTime) {
  const auto benefit = benefit_of(test::season(25, 100, 300));
  EXPECT_LT(benefit.back().high / benefit.back().low, benefit.front().high / benefit.front().low);
}

TEST(Benefit, ComparesOnePlannerOnlyAndLeavesOutWhatCouldNotBePlanned) {
  std::vector<AttemptSummary> attempts = test::season(12, 100, 300);
  const Benefit alone = benefit_of(attempts).back();
  for (int i = 0; i < 5; ++i) {
    attempts.push_back(
        test::attempt(test::kNoon_ms + 23'000, Outcome::Solved, 90'000, SamplingMode::Guided));
    attempts.back().record.planner = "rrt";
    attempts.push_back(
        test::attempt(test::kNoon_ms + 23'000, Outcome::Failed, 0, SamplingMode::Guided));
  }
  const RobotHistory robot = history_of("shelf", attempts, {}).robots.front();
  EXPECT_EQ(robot.planner, "birrt");
  EXPECT_EQ(robot.other_planners, 5U);
  EXPECT_DOUBLE_EQ(robot.benefit.back().ratio, alone.ratio);
  EXPECT_EQ(robot.benefit.back().guided, 12U);
}

TEST(Benefit, IsUnknownWithoutJudgedAttempts) {
  EXPECT_TRUE(benefit_of({test::attempt(test::kNoon_ms, Outcome::Solved, 5)}).empty());
}

}  // namespace
}  // namespace kinship::plots::benefit_test
