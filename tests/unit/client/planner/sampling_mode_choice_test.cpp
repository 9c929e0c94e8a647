#include "client/guided/sampling_mode_choice.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string>

namespace kinship::guided::arm_choice_test {
namespace {

constexpr std::uint64_t kQueries = 20'000;

/// Advice of a server that knows as many attempts, each with the checks of its arm.
Advice advice(std::uint64_t guided, std::uint64_t control, std::uint64_t guided_checks = 1000,
              std::uint64_t control_checks = 1000) {
  evidence::AttemptWindow window;
  for (std::uint64_t i = 0; i < guided; ++i)
    window.add(SamplingMode::Guided, true, guided_checks);
  for (std::uint64_t i = 0; i < control; ++i)
    window.add(SamplingMode::Control, true, control_checks);
  Advice advice;
  advice.recommended_share = 0.1;
  advice.guided_share = 0.9;
  advice.recent = window.recent();
  if (guided > 0)
    advice.guided = ModeEvidence{guided, guided, 1000};
  if (control > 0)
    advice.control = ModeEvidence{control, control, 1000};
  return advice;
}

Problem problem(std::uint64_t number) {
  Problem problem;
  problem.name = "p" + std::to_string(number);
  problem.start = Eigen::VectorXd::Zero(3);
  problem.goal_configurations = Eigen::MatrixXd::Ones(3, 1);
  return problem;
}

int count(const SamplingModeChooser& chooser, SamplingMode mode, std::uint64_t queries = kQueries) {
  int count = 0;
  for (std::uint64_t i = 0; i < queries; ++i)
    count += chooser.choose(sampling_mode_seed(problem(i))) == mode ? 1 : 0;
  return count;
}

TEST(GuidedShare, IsTheUsersElseTheServersForGuidedQueries) {
  EXPECT_EQ(guided_fraction(advice(0, 0), {}), 0.9);
  EXPECT_EQ(guided_fraction(advice(0, 0), {0.25, {}}), 0.25);
  EXPECT_THROW(guided_fraction(advice(0, 0), {1.5, {}}), std::invalid_argument);
}

TEST(SamplingModeChooser, RefusesSharesThatAreNone) {
  for (const double share : {-0.01, 1.01, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(SamplingModeChooser(advice(0, 0), {share, {}}), std::invalid_argument) << share;
    EXPECT_THROW(SamplingModeChooser(advice(0, 0), {{}, share}), std::invalid_argument) << share;
  }
}

TEST(SamplingModeChooser, WithoutEvidenceBothArmsAreTried) {
  const SamplingModeChooser chooser(advice(0, 0), {});
  EXPECT_NEAR(chooser.guided_part(), 0.639, 0.001);
  EXPECT_NEAR(count(chooser, SamplingMode::Guided), 0.639 * kQueries, 4 * 68);
  EXPECT_EQ(count(chooser, SamplingMode::Uniform), 0);
}

TEST(SamplingModeChooser, TheCheaperArmIsTakenButForTheFloors) {
  EXPECT_DOUBLE_EQ(SamplingModeChooser(advice(60, 60, 100, 1000), {}).guided_part(), 0.98);
  EXPECT_DOUBLE_EQ(SamplingModeChooser(advice(60, 60, 1000, 100), {}).guided_part(), 0.02);
}

TEST(SamplingModeChooser, WhatDoesNotPayInTimeIsNotUsedHoweverManyChecksItSaves) {
  SamplingModeChooser slow({}, {}), fast({}, {});
  for (int i = 0; i < 60; ++i) {
    slow.add(SamplingMode::Guided, Outcome::Solved, 100, 3e-3);
    slow.add(SamplingMode::Control, Outcome::Solved, 1000, 1e-3);
    fast.add(SamplingMode::Guided, Outcome::Solved, 1000, 1e-3);
    fast.add(SamplingMode::Control, Outcome::Solved, 100, 3e-3);
  }
  EXPECT_DOUBLE_EQ(slow.guided_part(), 0.02);
  EXPECT_DOUBLE_EQ(fast.guided_part(), 0.98);
}

TEST(SamplingModeChooser, ComparesWhatItKnowsAsOftenAsPlanningPaysForIt) {
  const auto changes = [](double time_s, double worse) {
    SamplingModeChooser chooser({}, {});
    int count = 0;
    for (int i = 0; i < 200; ++i) {
      const double before = chooser.guided_part();
      chooser.add(i % 2 == 0 ? SamplingMode::Guided : SamplingMode::Control, Outcome::Solved, 1000,
                  (1 + 0.7 * (i % 3)) * time_s * (i % 2 == 0 ? worse : 1));
      if (i >= 100)
        count += chooser.guided_part() != before ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(changes(1, 1), 100) << "plans are dear";
  EXPECT_LE(changes(1e-4, 1), 4) << "plans are cheap";
  EXPECT_GE(changes(1e-4, 1), 2) << "a fourth more is not left unseen";
}

TEST(SamplingModeChooser, AtLeastATenthIsControlUntilTwentyAreKnown) {
  EXPECT_DOUBLE_EQ(SamplingModeChooser(advice(60, 19, 100, 1000), {}).guided_part(), 0.9);
  SamplingModeChooser chooser(advice(60, 19, 100, 1000), {});
  chooser.add(SamplingMode::Control, Outcome::Timeout, 1000);
  EXPECT_DOUBLE_EQ(chooser.guided_part(), 0.98) << "its own attempts count, solved or not";
  Advice old = advice(60, 10, 100, 1000);
  old.control->attempts = 20;
  EXPECT_DOUBLE_EQ(SamplingModeChooser(old, {}).guided_part(), 0.98)
      << "also those that were forgotten";
}

// Seeds are fixed, so the counts are exact; the bounds are four standard deviations of a binomial
// count, which a biased draw of a few percent would leave.
TEST(SamplingModeChooser, TheFloorIsKeptInTheDraws) {
  EXPECT_NEAR(count(SamplingModeChooser(advice(60, 60, 100, 1000), {}), SamplingMode::Control), 400,
              4 * 20);
  EXPECT_NEAR(count(SamplingModeChooser(advice(60, 60, 1000, 100), {}), SamplingMode::Guided), 400,
              4 * 20);
}

TEST(SamplingModeChooser, AControlShareTakesThePlaceOfAllThat) {
  EXPECT_NEAR(
      count(SamplingModeChooser(advice(60, 60, 1000, 100), {{}, 0.1}), SamplingMode::Control), 2000,
      4 * 42);
  EXPECT_EQ(count(SamplingModeChooser(advice(60, 60, 1000, 100), {{}, 0.0}), SamplingMode::Guided),
            kQueries);
  EXPECT_EQ(count(SamplingModeChooser(advice(60, 60, 100, 1000), {{}, 1.0}), SamplingMode::Control),
            kQueries);
  EXPECT_FALSE(SamplingModeChooser(advice(0, 0), {{}, 0.0}).is_sampling());
}

TEST(SamplingModeChooser, AShareOfZeroIsUniformAndNoEvidence) {
  SamplingModeChooser chooser(advice(60, 60, 100, 1000), {0.0, 0.5});
  EXPECT_EQ(count(chooser, SamplingMode::Uniform, 100), 100);
  EXPECT_EQ(chooser.guided_part(), 0);
}

TEST(SamplingModeChooser, EqualQueryAndEqualEvidenceGiveEqualArms) {
  const SamplingModeChooser first(advice(5, 5), {}), second(advice(5, 5), {});
  for (std::uint64_t i = 0; i < 200; ++i)
    EXPECT_EQ(first.choose(sampling_mode_seed(problem(i))),
              second.choose(sampling_mode_seed(problem(i))));
}

TEST(SamplingModeChooser, TheSameQueryAgainIsAnotherDraw) {
  SamplingModeChooser chooser(advice(0, 0), {});
  std::set<SamplingMode> arms;
  for (int i = 0; i < 30; ++i) {
    const SamplingMode mode = chooser.choose(sampling_mode_seed(problem(0)));
    arms.insert(mode);
    chooser.add(mode, Outcome::Solved, 1000);
  }
  EXPECT_EQ(arms.size(), 2U);
}

TEST(SamplingModeChooser, AFixedShareDrawsTheSameQueriesWhateverIsKnown) {
  SamplingModeChooser chooser(advice(0, 0), {{}, 0.3});
  std::vector<SamplingMode> before;
  for (std::uint64_t i = 0; i < 200; ++i)
    before.push_back(chooser.choose(i));
  chooser.add(SamplingMode::Guided, Outcome::Solved, 10);
  for (std::uint64_t i = 0; i < 200; ++i)
    EXPECT_EQ(chooser.choose(i), before[i]);
  const SamplingModeChooser more(advice(0, 0), {{}, 0.5});
  for (std::uint64_t i = 0; i < 200; ++i)
    if (before[i] == SamplingMode::Control) {
      EXPECT_EQ(more.choose(i), SamplingMode::Control)
          << "a larger part has the same queries and more";
    }
}

/// 200 queries with the evidence of the start alone: the client learns from what it does.
TEST(SamplingModeChooser, LearnsFromItsOwnQueries) {
  for (const bool guidance_helps : {true, false}) {
    SamplingModeChooser chooser(advice(0, 0), {});
    int guided = 0;
    for (std::uint64_t i = 0; i < 200; ++i) {
      const SamplingMode mode = chooser.choose(sampling_mode_seed(problem(i)));
      const std::uint64_t varied = 500 + 37 * i % 1000;
      const bool is_dear = (mode == SamplingMode::Guided) != guidance_helps;
      chooser.add(mode, Outcome::Solved, is_dear ? 4 * varied : varied);
      guided += i >= 100 && mode == SamplingMode::Guided ? 1 : 0;
    }
    if (guidance_helps)
      EXPECT_GE(guided, 80);
    else
      EXPECT_LE(guided, 20);
  }
}

TEST(SamplingModeChooser, WhatCouldNotBePlannedAtAllTeachesNothing) {
  SamplingModeChooser chooser(advice(5, 5, 3000, 1000), {});
  const double before = chooser.guided_part();
  chooser.add(SamplingMode::Guided, Outcome::Failed, 1);
  chooser.add(SamplingMode::Uniform, Outcome::Solved, 10);
  EXPECT_EQ(chooser.guided_part(), before);
  chooser.add(SamplingMode::Guided, Outcome::Solved, 1, 10);
  EXPECT_NE(chooser.guided_part(), before);
}

TEST(SamplingModeSeed, IsTheSameForTheSameQueryOnly) {
  EXPECT_EQ(sampling_mode_seed(problem(3)), sampling_mode_seed(problem(3)));
  std::set<std::uint64_t> seeds = {sampling_mode_seed(problem(3))};
  Problem other = problem(3);
  other.name = "p4";
  seeds.insert(sampling_mode_seed(other));
  other = problem(3);
  other.seed = 1;
  seeds.insert(sampling_mode_seed(other));
  other = problem(3);
  other.start[2] = 1e-9;
  seeds.insert(sampling_mode_seed(other));
  other = problem(3);
  other.goal_configurations(0, 0) = 2;
  seeds.insert(sampling_mode_seed(other));
  other = problem(3);
  other.goal_configurations.resize(0, 0);
  other.T_task_goal = Eigen::Isometry3d::Identity();
  seeds.insert(sampling_mode_seed(other));
  other.T_task_start = Eigen::Isometry3d(Eigen::Translation3d(0, 0, 1));
  seeds.insert(sampling_mode_seed(other));
  EXPECT_EQ(seeds.size(), 7U);
}

}  // namespace
}  // namespace kinship::guided::arm_choice_test
