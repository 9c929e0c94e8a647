#include "pages/plots/task_history.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/pages/plots/history_values.hpp"

namespace kinship::plots::task_history_test {
namespace {

using test::attempt;
using test::kNoon_ms;

constexpr std::int64_t kHour_ms = 3'600'000;

TEST(CheckQuartiles, AreThoseOfTheSolvedOnes) {
  const CheckQuartiles quartiles = check_quartiles({50, 10, 40, 20, 30}, 0);
  EXPECT_EQ(quartiles, (CheckQuartiles{20, 30, 40}));
  EXPECT_EQ(check_quartiles({1, 2}, 0), (CheckQuartiles{1.25, 1.5, 1.75}));
}

TEST(CheckQuartiles, AnUnsolvedAttemptIsDearerThanEverySolvedOne) {
  EXPECT_EQ(check_quartiles({10, 20, 30}, 2), (CheckQuartiles{20, 30, std::nullopt}));
  EXPECT_EQ(check_quartiles({10}, 4), CheckQuartiles{});
  EXPECT_EQ(check_quartiles({}, 3), CheckQuartiles{});
}

TEST(BinLength, IsTheShortestThatReaches) {
  EXPECT_EQ(bin_length_ms(kNoon_ms, kNoon_ms), 1000);
  EXPECT_EQ(bin_length_ms(kNoon_ms, kNoon_ms + 59'000), 1000);
  EXPECT_EQ(bin_length_ms(kNoon_ms, kNoon_ms + 61'000), 5000);
  EXPECT_EQ(bin_length_ms(kNoon_ms, kNoon_ms + 48 * kHour_ms), kHour_ms);
  EXPECT_EQ(bin_length_ms(kNoon_ms, kNoon_ms + 30 * 24 * kHour_ms), 24 * kHour_ms);
  const std::int64_t years = 20 * 365 * 24 * kHour_ms;
  EXPECT_LT(years / bin_length_ms(kNoon_ms, kNoon_ms + years), static_cast<int>(kMaxBins));
}

TEST(TaskHistory, CountsWhatEachRobotDidUpToTheEndOfEachBin) {
  const TaskHistory history = history_of(
      "shelf",
      {attempt(kNoon_ms, Outcome::Solved, 100), attempt(kNoon_ms + 200, Outcome::Timeout, 900),
       attempt(kNoon_ms + 300, Outcome::Failed, 0), attempt(kNoon_ms + 3100, Outcome::Solved, 300),
       attempt(kNoon_ms + 3200, Outcome::Solved, 70, SamplingMode::Guided, 2)},
      {});
  EXPECT_EQ(history.from_ms, kNoon_ms);
  EXPECT_EQ(history.bin_ms, 1000);
  EXPECT_EQ(history.bins, 4U);
  ASSERT_EQ(history.robots.size(), 2U);
  const RobotHistory& robot = history.robots[0];
  EXPECT_EQ(robot.label, "arm1");
  EXPECT_EQ(robot.attempts, 4U);
  EXPECT_EQ(robot.solved, 2U);
  EXPECT_EQ(robot.unsolved, 1U);
  EXPECT_EQ(robot.not_planned, 1U);
  ASSERT_EQ(robot.bins.size(), 2U) << "bins without attempts are left out";
  EXPECT_EQ(robot.bins[0].attempts, 3U);
  EXPECT_EQ(robot.bins[0].paths, 1U);
  EXPECT_EQ(robot.bins[1].bin, 3U);
  EXPECT_EQ(robot.bins[1].attempts, 4U);
  EXPECT_EQ(robot.bins[1].paths, 2U);
  const ModeCounts& uniform = robot.bins[0].modes[static_cast<int>(SamplingMode::Uniform)];
  EXPECT_EQ(uniform.attempts, 2U) << "without what could not be planned";
  EXPECT_EQ(uniform.solved, 1U);
  EXPECT_EQ(robot.bins[0].modes[static_cast<int>(SamplingMode::Guided)].attempts, 0U);
  EXPECT_EQ(history.robots[1].bins[0].modes[static_cast<int>(SamplingMode::Guided)].checks.median,
            70);
}

TEST(TaskHistory, ClocksThatWentBackLoseNothing) {
  const TaskHistory history = history_of(
      "shelf",
      {attempt(kNoon_ms + 5000, Outcome::Solved, 100), attempt(kNoon_ms, Outcome::Solved, 100)},
      {});
  EXPECT_EQ(history.bins, 6U);
  ASSERT_EQ(history.robots.front().bins.size(), 2U);
  EXPECT_EQ(history.robots.front().bins.back().attempts, 2U);
}

TEST(TaskHistory, KnowsTheRevisionsThatWereUsedAndThoseThatAreKept) {
  const Digest id{{7}};
  std::vector<AttemptSummary> attempts = test::season(2, 100, 200);
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    attempts[i].record.distribution_id = id;
    attempts[i].record.distribution_revision = i < 3 ? 1 : 2;
  }
  DistributionSummary kept;
  kept.id = id;
  kept.revision = 2;
  kept.label = "arm1";
  kept.fitted_ms = kNoon_ms + 2500;
  DistributionSummary unused = kept;
  unused.id = Digest{{8}};
  unused.fitted_ms = kNoon_ms - 1;
  const auto revisions = history_of("shelf", attempts, {kept, unused}).revisions;
  ASSERT_EQ(revisions.size(), 3U);
  EXPECT_EQ(revisions[0].id, unused.id);
  EXPECT_EQ(revisions[0].attempts, 0U);
  EXPECT_EQ(revisions[0].first_ms, 0);
  EXPECT_EQ(revisions[1].revision, 1U);
  EXPECT_EQ(revisions[1].attempts, 3U);
  EXPECT_EQ(revisions[1].first_ms, kNoon_ms);
  EXPECT_EQ(revisions[1].fitted_ms, 0) << "nobody knows any more";
  EXPECT_EQ(revisions[2].attempts, 1U);
  EXPECT_EQ(revisions[2].fitted_ms, kept.fitted_ms);
}

TEST(TaskHistory, TimesThatNoClockShowsAreBroughtIntoTheCalendar) {
  constexpr std::int64_t kEndOf9999_ms = 253'402'300'799'999;
  const TaskHistory history =
      history_of("shelf",
                 {attempt(std::numeric_limits<std::int64_t>::min(), Outcome::Solved, 100),
                  attempt(std::numeric_limits<std::int64_t>::max(), Outcome::Solved, 100)},
                 {});
  EXPECT_EQ(history.from_ms, 0);
  EXPECT_LE(history.bins, kMaxBins);
  EXPECT_GT(history.from_ms + static_cast<std::int64_t>(history.bins) * history.bin_ms,
            kEndOf9999_ms);
  EXPECT_EQ(history.robots.front().bins.back().bin, history.bins - 1);
}

TEST(TaskHistory, OfNothingIsRefused) {
  EXPECT_THROW(history_of("shelf", {}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::plots::task_history_test
