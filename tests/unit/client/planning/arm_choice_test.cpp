#include "client/planning/arm_choice.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string>

namespace kinship::planning::arm_choice_test {
namespace {

constexpr std::uint64_t kQueries = 20'000;

/// Advice of a server that knows as many attempts, each with the checks of its arm.
Advice advice(std::uint64_t guided, std::uint64_t control, std::uint64_t guided_checks = 1000,
              std::uint64_t control_checks = 1000) {
  evidence::AttemptWindow window;
  for (std::uint64_t i = 0; i < guided; ++i)
    window.add(Arm::Guided, true, guided_checks);
  for (std::uint64_t i = 0; i < control; ++i)
    window.add(Arm::Control, true, control_checks);
  Advice advice;
  advice.recommended_share = 0.1;
  advice.guided_share = 0.9;
  advice.recent = window.recent();
  if (guided > 0)
    advice.guided = ArmEvidence{guided, guided, 1000};
  if (control > 0)
    advice.control = ArmEvidence{control, control, 1000};
  return advice;
}

Problem problem(std::uint64_t number) {
  Problem problem;
  problem.name = "p" + std::to_string(number);
  problem.start = Eigen::VectorXd::Zero(3);
  problem.goal_configurations = Eigen::MatrixXd::Ones(3, 1);
  return problem;
}

int count(const ArmChooser& chooser, Arm arm, std::uint64_t queries = kQueries) {
  int count = 0;
  for (std::uint64_t i = 0; i < queries; ++i)
    count += chooser.choose(arm_seed(problem(i))) == arm ? 1 : 0;
  return count;
}

TEST(GuidedShare, IsTheUsersElseTheServersForGuidedQueries) {
  EXPECT_EQ(guided_fraction(advice(0, 0), {}), 0.9);
  EXPECT_EQ(guided_fraction(advice(0, 0), {0.25, {}}), 0.25);
  EXPECT_THROW(guided_fraction(advice(0, 0), {1.5, {}}), std::invalid_argument);
}

TEST(ArmChooser, RefusesSharesThatAreNone) {
  for (const double share : {-0.01, 1.01, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(ArmChooser(advice(0, 0), {share, {}}), std::invalid_argument) << share;
    EXPECT_THROW(ArmChooser(advice(0, 0), {{}, share}), std::invalid_argument) << share;
  }
}

TEST(ArmChooser, WithoutEvidenceBothArmsAreTried) {
  const ArmChooser chooser(advice(0, 0), {});
  EXPECT_NEAR(chooser.guided_part(), 0.639, 0.001);
  EXPECT_NEAR(count(chooser, Arm::Guided), 0.639 * kQueries, 4 * 68);
  EXPECT_EQ(count(chooser, Arm::Uniform), 0);
}

TEST(ArmChooser, TheCheaperArmIsTakenButForTheFloors) {
  EXPECT_DOUBLE_EQ(ArmChooser(advice(60, 60, 100, 1000), {}).guided_part(), 0.98);
  EXPECT_DOUBLE_EQ(ArmChooser(advice(60, 60, 1000, 100), {}).guided_part(), 0.02);
}

TEST(ArmChooser, AtLeastATenthIsControlUntilTwentyAreKnown) {
  EXPECT_DOUBLE_EQ(ArmChooser(advice(60, 19, 100, 1000), {}).guided_part(), 0.9);
  ArmChooser chooser(advice(60, 19, 100, 1000), {});
  chooser.add(Arm::Control, Outcome::Timeout, 1000);
  EXPECT_DOUBLE_EQ(chooser.guided_part(), 0.98) << "its own attempts count, solved or not";
  Advice old = advice(60, 10, 100, 1000);
  old.control->attempts = 20;
  EXPECT_DOUBLE_EQ(ArmChooser(old, {}).guided_part(), 0.98) << "also those that were forgotten";
}

// Seeds are fixed, so the counts are exact; the bounds are four standard deviations of a binomial
// count, which a biased draw of a few percent would leave.
TEST(ArmChooser, TheFloorIsKeptInTheDraws) {
  EXPECT_NEAR(count(ArmChooser(advice(60, 60, 100, 1000), {}), Arm::Control), 400, 4 * 20);
  EXPECT_NEAR(count(ArmChooser(advice(60, 60, 1000, 100), {}), Arm::Guided), 400, 4 * 20);
}

TEST(ArmChooser, AControlShareTakesThePlaceOfAllThat) {
  EXPECT_NEAR(count(ArmChooser(advice(60, 60, 1000, 100), {{}, 0.1}), Arm::Control), 2000, 4 * 42);
  EXPECT_EQ(count(ArmChooser(advice(60, 60, 1000, 100), {{}, 0.0}), Arm::Guided), kQueries);
  EXPECT_EQ(count(ArmChooser(advice(60, 60, 100, 1000), {{}, 1.0}), Arm::Control), kQueries);
  EXPECT_FALSE(ArmChooser(advice(0, 0), {{}, 0.0}).is_sampling());
}

TEST(ArmChooser, AShareOfZeroIsUniformAndNoEvidence) {
  ArmChooser chooser(advice(60, 60, 100, 1000), {0.0, 0.5});
  EXPECT_EQ(count(chooser, Arm::Uniform, 100), 100);
  EXPECT_EQ(chooser.guided_part(), 0);
}

TEST(ArmChooser, EqualQueryAndEqualEvidenceGiveEqualArms) {
  const ArmChooser first(advice(5, 5), {}), second(advice(5, 5), {});
  for (std::uint64_t i = 0; i < 200; ++i)
    EXPECT_EQ(first.choose(arm_seed(problem(i))), second.choose(arm_seed(problem(i))));
}

TEST(ArmChooser, TheSameQueryAgainIsAnotherDraw) {
  ArmChooser chooser(advice(0, 0), {});
  std::set<Arm> arms;
  for (int i = 0; i < 30; ++i) {
    const Arm arm = chooser.choose(arm_seed(problem(0)));
    arms.insert(arm);
    chooser.add(arm, Outcome::Solved, 1000);
  }
  EXPECT_EQ(arms.size(), 2U);
}

TEST(ArmChooser, AFixedShareDrawsTheSameQueriesWhateverIsKnown) {
  ArmChooser chooser(advice(0, 0), {{}, 0.3});
  std::vector<Arm> before;
  for (std::uint64_t i = 0; i < 200; ++i)
    before.push_back(chooser.choose(i));
  chooser.add(Arm::Guided, Outcome::Solved, 10);
  for (std::uint64_t i = 0; i < 200; ++i)
    EXPECT_EQ(chooser.choose(i), before[i]);
  const ArmChooser more(advice(0, 0), {{}, 0.5});
  for (std::uint64_t i = 0; i < 200; ++i)
    if (before[i] == Arm::Control) {
      EXPECT_EQ(more.choose(i), Arm::Control) << "a larger part has the same queries and more";
    }
}

/// 200 queries with the evidence of the start alone: the client learns from what it does.
TEST(ArmChooser, LearnsFromItsOwnQueries) {
  for (const bool guidance_helps : {true, false}) {
    ArmChooser chooser(advice(0, 0), {});
    int guided = 0;
    for (std::uint64_t i = 0; i < 200; ++i) {
      const Arm arm = chooser.choose(arm_seed(problem(i)));
      const std::uint64_t varied = 500 + 37 * i % 1000;
      const bool is_dear = (arm == Arm::Guided) != guidance_helps;
      chooser.add(arm, Outcome::Solved, is_dear ? 4 * varied : varied);
      guided += i >= 100 && arm == Arm::Guided ? 1 : 0;
    }
    if (guidance_helps)
      EXPECT_GE(guided, 80);
    else
      EXPECT_LE(guided, 20);
  }
}

TEST(ArmChooser, WhatCouldNotBePlannedAtAllTeachesNothing) {
  ArmChooser chooser(advice(5, 5, 3000, 1000), {});
  const double before = chooser.guided_part();
  chooser.add(Arm::Guided, Outcome::Failed, 1);
  chooser.add(Arm::Uniform, Outcome::Solved, 10);
  EXPECT_EQ(chooser.guided_part(), before);
  chooser.add(Arm::Guided, Outcome::Solved, 1);
  EXPECT_NE(chooser.guided_part(), before);
}

TEST(ArmSeed, IsTheSameForTheSameQueryOnly) {
  EXPECT_EQ(arm_seed(problem(3)), arm_seed(problem(3)));
  std::set<std::uint64_t> seeds = {arm_seed(problem(3))};
  Problem other = problem(3);
  other.name = "p4";
  seeds.insert(arm_seed(other));
  other = problem(3);
  other.seed = 1;
  seeds.insert(arm_seed(other));
  other = problem(3);
  other.start[2] = 1e-9;
  seeds.insert(arm_seed(other));
  other = problem(3);
  other.goal_configurations(0, 0) = 2;
  seeds.insert(arm_seed(other));
  other = problem(3);
  other.goal_configurations.resize(0, 0);
  other.T_task_goal = Eigen::Isometry3d::Identity();
  seeds.insert(arm_seed(other));
  EXPECT_EQ(seeds.size(), 6U);
}

}  // namespace
}  // namespace kinship::planning::arm_choice_test
