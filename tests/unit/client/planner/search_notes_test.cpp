#include "client/guided/search_notes.hpp"

#include <gtest/gtest.h>

#include "client/cli/attempt_commands.hpp"
#include "client/guided/attempt_record.hpp"
#include "client/guided/scene_record.hpp"
#include "tests/unit/client/planner/plan_problem_answers.hpp"

namespace kinship::guided::search_notes_test {
namespace {

using plan_problem_test::planned;
using test::planar_robot;
using test::wall_problem;

PlanSettings giving_up_after(std::uint64_t checks, RecordSearch record = RecordSearch::Failed) {
  PlanSettings settings;
  settings.max_checks = checks;
  settings.record_search = record;
  return settings;
}

TEST(SearchNotes, AFailedSearchNamesTheBodyInTheWay) {
  const Problem problem = wall_problem();
  const PlannedProblem answer = planned(problem, giving_up_after(300));
  ASSERT_FALSE(answer.result.solved);
  ASSERT_TRUE(answer.search);
  const SearchRecord& search = *answer.search;
  EXPECT_EQ(search.start, problem.start);
  EXPECT_EQ(search.goals, problem.goal_configurations);
  EXPECT_EQ(search.seed, problem.seed);
  EXPECT_EQ(search.reason, "not solved within 300 collision checks");
  ASSERT_FALSE(search.blockers.empty());
  EXPECT_EQ(search.blockers[0].second, "wall");
  EXPECT_GE(search.blockers[0].count, 3U);
  EXPECT_TRUE(search.goal_contacts.empty());
  ASSERT_EQ(search.last_free.size(), 4);
  EXPECT_TRUE(search.trees.empty());
}

TEST(SearchNotes, TheLastFreeConfigurationIsTheNearestOfTheStartTree) {
  const Problem problem = wall_problem();
  const SearchRecord search = *planned(problem, giving_up_after(300, RecordSearch::Slow)).search;
  ASSERT_EQ(search.trees.size(), 2U);
  const Eigen::MatrixXd from_start = search.trees[0].configurations.cast<double>();
  EXPECT_TRUE(from_start.col(0).isApprox(problem.start, 1e-6));
  EXPECT_EQ(search.trees[0].parents[0], -1);
  const Eigen::VectorXd goal = problem.goal_configurations.col(0);
  const double nearest = (from_start.colwise() - goal).colwise().norm().minCoeff();
  EXPECT_NEAR((search.last_free - goal).norm(), nearest, 1e-5);
}

TEST(SearchNotes, WhatIsNotedChangesNothingOfTheSearch) {
  for (const std::uint64_t checks : {300U, 100'000U}) {
    const ProblemResult plain =
        planned(wall_problem(), giving_up_after(checks, RecordSearch::Never)).result;
    for (const RecordSearch record : {RecordSearch::Failed, RecordSearch::All}) {
      const ProblemResult noted = planned(wall_problem(), giving_up_after(checks, record)).result;
      EXPECT_EQ(noted.collision_checks, plain.collision_checks);
      EXPECT_EQ(noted.waypoints, plain.waypoints);
    }
  }
}

TEST(SearchNotes, WhatIsRecordedIsAsWanted) {
  const auto has_search = [](std::uint64_t checks, RecordSearch record, double slow_s) {
    PlanSettings settings = giving_up_after(checks, record);
    settings.slow_time_s = slow_s;
    return planned(wall_problem(), settings).search.has_value();
  };
  constexpr double kNever = 1e9;
  EXPECT_FALSE(has_search(300, RecordSearch::Never, 0));
  EXPECT_FALSE(has_search(100'000, RecordSearch::Failed, 0));
  EXPECT_TRUE(has_search(300, RecordSearch::Slow, kNever));
  EXPECT_FALSE(has_search(100'000, RecordSearch::Slow, kNever));
  EXPECT_TRUE(has_search(100'000, RecordSearch::Slow, 0));
  EXPECT_TRUE(has_search(100'000, RecordSearch::All, kNever));
}

TEST(SearchNotes, GoalsThatTouchAreRecordedWithWhatTheyTouch) {
  Problem problem = wall_problem();
  problem.scene.objects.push_back(
      {"lump", SphereShape{0.25}, Eigen::Isometry3d(Eigen::Translation3d(0.45, -0.95, 0))});
  const SearchRecord search = *planned(problem).search;
  ASSERT_FALSE(search.goal_contacts.empty());
  EXPECT_EQ(search.goal_contacts[0].goal, 0U);
  EXPECT_EQ(search.goal_contacts[0].second, "lump");
  problem = wall_problem();
  problem.start.setZero();
  EXPECT_EQ(planned(problem).search->reason, "start collides: 'l4' touches 'wall'");
}

TEST(SearchNotes, AnExportedAttemptIsPlannedAgainAlike) {
  Problem problem = wall_problem();
  problem.attached = {{"tool", "l4", SphereShape{0.01}}};
  const PlanSettings settings = giving_up_after(300);
  const PlannedRobot robot = planar_robot();
  const PlannedProblem answer = planned(problem, settings);
  Attempt attempt = make_attempt({robot, "cell", "turn"}, problem, answer, settings);
  attempt.scene = record_scene(robot.chain, problem).value_or_throw();
  ASSERT_FALSE(validate(attempt));
  const Problem again = cli::problem_of(attempt, robot.chain).value_or_throw();
  EXPECT_EQ(again.time_limit_s, problem.time_limit_s);
  const PlannedProblem second = planned(again, settings);
  EXPECT_EQ(second.result.collision_checks, answer.result.collision_checks);
  EXPECT_EQ(second.result.reason, answer.result.reason);
  ASSERT_EQ(second.search->blockers.size(), answer.search->blockers.size());
  EXPECT_EQ(second.search->blockers[0].count, answer.search->blockers[0].count);
  attempt.search.reset();
  EXPECT_EQ(cli::problem_of(attempt, robot.chain).error().code, ErrorCode::InvalidInput);
}

}  // namespace
}  // namespace kinship::guided::search_notes_test
