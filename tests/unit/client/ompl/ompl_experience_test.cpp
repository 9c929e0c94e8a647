#include "client/ompl/ompl_experience.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/unit/robots/planning/wall_world.hpp"

namespace kinship::ompl_planners::ompl_experience_test {
namespace {

using planning::BirrtOptions;
using planning::NoPath;
using planning::PlanSummary;
using planning::test_support::at;
using planning::test_support::kStep;
using planning::test_support::square_bounds;
using planning::test_support::stepped;
using planning::test_support::WallWorld;

/// From the left of the wall through its gap to the right.
Eigen::MatrixXd path_through(double gap) {
  Eigen::MatrixXd path(2, 4);
  path << -0.8, -0.3, 0.3, 0.8, -0.5, gap, gap, -0.5;
  return path;
}

BirrtOptions limits(std::uint64_t max_checks = 50'000) {
  BirrtOptions limits = stepped();
  limits.max_checks = max_checks;
  limits.time_limit = std::chrono::seconds(600);
  return limits;
}

class Experience : public testing::TestWithParam<ExperienceKind> {
 protected:
  PlanSummary recall(const Eigen::MatrixXd& goals, std::uint64_t max_checks = 50'000) {
    std::mt19937_64 generator(5);
    return experience.recall(at(-0.75, -0.45), goals, world.is_free(), limits(max_checks),
                             generator);
  }

  WallWorld world;
  OmplExperience experience{GetParam(), square_bounds(), kStep, 0};
};

INSTANTIATE_TEST_SUITE_P(Both, Experience,
                         testing::Values(ExperienceKind::Lightning, ExperienceKind::Thunder),
                         [](const auto& kind) {
                           return kind.param == ExperienceKind::Lightning ? "Lightning" : "Thunder";
                         });

TEST_P(Experience, KnowsNothingAtFirst) {
  const PlanSummary summary = recall(at(0.7, -0.4));
  EXPECT_FALSE(summary.waypoints);
  EXPECT_EQ(summary.reason, NoPath::NothingRecalled);
  EXPECT_EQ(summary.collision_checks, 0U);
}

TEST_P(Experience, RecallsAPathThatStillHolds) {
  EXPECT_TRUE(experience.learn(path_through(0.7), world.is_free()));
  EXPECT_GT(experience.size(), 0U);
  world.asked = 0;
  const PlanSummary summary = recall(at(0.7, -0.4));
  ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
  EXPECT_EQ(summary.waypoints->leftCols<1>(), at(-0.75, -0.45));
  EXPECT_EQ(summary.waypoints->rightCols<1>(), at(0.7, -0.4));
  EXPECT_TRUE(world.path_is_free(*summary.waypoints, kStep));
  EXPECT_GT(summary.collision_checks, 0U);
  // What is looked at once more at the end is no check of the planner's.
  EXPECT_EQ(world.asked,
            summary.collision_checks + static_cast<std::uint64_t>(summary.waypoints->cols()));
}

TEST_P(Experience, EndsWithItsBudget) {
  experience.learn(path_through(0.7), world.is_free());
  world.asked = 0;
  const PlanSummary summary = recall(at(0.7, -0.4), 5);
  EXPECT_FALSE(summary.waypoints);
  EXPECT_EQ(summary.reason, NoPath::MaxChecks);
  EXPECT_EQ(world.asked, 5U);
}

TEST_P(Experience, MayRecallToAnyGoal) {
  experience.learn(path_through(0.7), world.is_free());
  Eigen::MatrixXd goals(2, 2);
  goals << 0, 0.7, 0, -0.4;  // the first one is in the wall
  const PlanSummary summary = recall(goals);
  ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
  EXPECT_EQ(summary.waypoints->rightCols<1>(), at(0.7, -0.4));
}

TEST(LightningExperience, RepairsWhatIsInTheWay) {
  WallWorld learned, other;
  learned.gap_lower = -1;
  other.gap_lower = 0.2;
  other.gap_upper = 0.5;
  OmplExperience experience(ExperienceKind::Lightning, square_bounds(), kStep, 0);
  experience.learn(path_through(0.7), learned.is_free());
  std::mt19937_64 generator(5);
  const PlanSummary summary =
      experience.recall(at(-0.75, -0.45), at(0.7, -0.4), other.is_free(), limits(), generator);
  ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
  EXPECT_TRUE(other.path_is_free(*summary.waypoints, kStep));
}

TEST(LightningExperience, RefusesAStepOfNothing) {
  EXPECT_THROW(OmplExperience(ExperienceKind::Lightning, square_bounds(), 0, 0),
               std::invalid_argument);
}

}  // namespace
}  // namespace kinship::ompl_planners::ompl_experience_test
