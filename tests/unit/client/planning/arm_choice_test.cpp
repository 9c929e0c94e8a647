#include "client/planning/arm_choice.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string>

namespace kinship::planning {
namespace {

Advice advice(double share, std::uint64_t guided, std::uint64_t control) {
  Advice advice;
  advice.recommended_share = share;
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

int controls(const ArmPlan& plan, std::uint64_t queries) {
  int count = 0;
  for (std::uint64_t i = 0; i < queries; ++i)
    if (choose_arm(plan, arm_seed(problem(i))).arm == Arm::Control)
      ++count;
  return count;
}

TEST(PlanArms, TestsATenthUntilTwentyControlsAreKnownThenOneInFifty) {
  EXPECT_EQ(plan_arms(advice(0.9, 0, 0), {}), (ArmPlan{0.9, true, 0.1}));
  EXPECT_EQ(plan_arms(advice(0.9, 500, 19), {}), (ArmPlan{0.9, true, 0.1}));
  EXPECT_EQ(plan_arms(advice(0.9, 0, 20), {}), (ArmPlan{0.9, true, 0.02}));
}

TEST(PlanArms, TurnsTheRolesWhereUniformIsAdvised) {
  EXPECT_EQ(plan_arms(advice(0, 500, 500), {}), (ArmPlan{kTrialShare, false, 0.02}));
  EXPECT_EQ(plan_arms(advice(0, 10, 500), {}), (ArmPlan{kTrialShare, false, 0.1}));
  EXPECT_EQ(plan_arms(advice(0.049, 500, 500), {}), (ArmPlan{kTrialShare, false, 0.02}));
  EXPECT_EQ(plan_arms(advice(0.05, 500, 500), {}), (ArmPlan{0.05, true, 0.02}));
  EXPECT_EQ(plan_arms(advice(0, 500, 500), {0.01, {}}), (ArmPlan{0.01, true, 0.02}));
}

TEST(PlanArms, DoesWhatItIsTold) {
  EXPECT_EQ(plan_arms(advice(0.9, 0, 0), {0.25, {}}), (ArmPlan{0.25, true, 0.1}));
  EXPECT_EQ(plan_arms(advice(0, 50, 50), {0.25, {}}), (ArmPlan{0.25, true, 0.02}));
  EXPECT_EQ(plan_arms(advice(0.9, 0, 0), {{}, 0.5}), (ArmPlan{0.9, true, 0.5}));
  EXPECT_EQ(plan_arms(advice(0.9, 0, 0), {{}, 0.0}), (ArmPlan{0.9, true, 0}));
  EXPECT_EQ(plan_arms(advice(0.9, 0, 0), {0.0, {}}), (ArmPlan{0, false, 0}));
}

TEST(PlanArms, RefusesSharesThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double share : {-0.01, 1.01, nan}) {
    EXPECT_THROW(plan_arms(advice(share, 0, 0), {}), std::invalid_argument) << share;
    EXPECT_THROW(plan_arms(advice(0.9, 0, 0), {share, {}}), std::invalid_argument) << share;
    EXPECT_THROW(plan_arms(advice(0.9, 0, 0), {{}, share}), std::invalid_argument) << share;
  }
}

TEST(ChooseArm, KeepsTheShareOfTheArm) {
  EXPECT_EQ(choose_arm({0.7, true, 0}, 5), (ArmChoice{Arm::Guided, 0.7}));
  EXPECT_EQ(choose_arm({0.7, true, 1}, 5), (ArmChoice{Arm::Control, 0}));
  EXPECT_EQ(choose_arm({0.7, false, 0}, 5), (ArmChoice{Arm::Control, 0}));
  EXPECT_EQ(choose_arm({0.7, false, 1}, 5), (ArmChoice{Arm::Guided, 0.7}));
}

// Seeds are fixed, so the counts are exact; the bounds are four standard deviations of a binomial
// count, which a biased draw of a few percent would leave.
TEST(ChooseArm, PartsAreKeptOnAverage) {
  constexpr std::uint64_t kQueries = 20'000;
  EXPECT_NEAR(controls({0.9, true, 0.1}, kQueries), 2000, 4 * 42);
  EXPECT_NEAR(controls({0.9, true, 0.02}, kQueries), 400, 4 * 20);
  EXPECT_NEAR(controls({0.9, true, 0.5}, kQueries), 10'000, 4 * 71);
  EXPECT_NEAR(controls({0.9, false, 0.02}, kQueries), 19'600, 4 * 20);
  EXPECT_EQ(controls({0.9, true, 0}, kQueries), 0);
  EXPECT_EQ(controls({0.9, true, 1}, kQueries), 20'000);
}

TEST(ChooseArm, ALargerPartTestsTheSameQueriesAndMore) {
  for (std::uint64_t i = 0; i < 2000; ++i)
    if (choose_arm({0.9, true, 0.02}, arm_seed(problem(i))).arm == Arm::Control) {
      EXPECT_EQ(choose_arm({0.9, true, 0.1}, arm_seed(problem(i))).arm, Arm::Control);
    }
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
}  // namespace kinship::planning
