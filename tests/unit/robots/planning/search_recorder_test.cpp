#include "robots/planning/tree.hpp"

#include <gtest/gtest.h>

#include "robots/planning/birrt.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/unit/robots/planning/wall_world.hpp"

namespace kinship::planning::search_recorder_test {
namespace {

using namespace test_support;

struct Planned {
  PlanSummary summary;
  std::mt19937_64 generator;  ///< after the plan
};

Planned plan(std::uint64_t seed, SearchRecorder* recorder) {
  WallWorld world;
  BirrtOptions options = stepped();
  options.recorder = recorder;
  Planned planned{{}, std::mt19937_64(seed)};
  planned.summary = plan_birrt(kStart, kGoal, world.is_free(),
                               ConfigurationSampler(square_bounds()), options, planned.generator);
  return planned;
}

TEST(SearchRecorder, ChangesNothingOfTheSearch) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SearchRecorder recorder;
    const Planned without = plan(seed, nullptr);
    const Planned with = plan(seed, &recorder);
    ASSERT_TRUE(without.summary.waypoints);
    EXPECT_EQ(*with.summary.waypoints, *without.summary.waypoints);
    EXPECT_EQ(with.summary.collision_checks, without.summary.collision_checks);
    EXPECT_EQ(with.summary.iterations, without.summary.iterations);
    EXPECT_EQ(with.generator, without.generator);
  }
}

TEST(SearchRecorder, ItsPathIsThePlans) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SearchRecorder recorder;
    const PlanSummary summary = plan(seed, &recorder).summary;
    const RecordedSearch search = recorder.search();
    Eigen::MatrixXd path(2, static_cast<Eigen::Index>(search.path.size()));
    for (std::size_t i = 0; i < search.path.size(); ++i)
      path.col(static_cast<Eigen::Index>(i)) = search.nodes.col(search.path[i]);
    ASSERT_TRUE(summary.waypoints);
    // Both trees hold the node in which they met.
    ASSERT_EQ(path.cols(), summary.waypoints->cols() + 1);
    Eigen::Index meeting = 1;
    while (meeting < path.cols() && path.col(meeting) != path.col(meeting - 1))
      ++meeting;
    ASSERT_LT(meeting, path.cols());
    EXPECT_EQ(path.leftCols(meeting), summary.waypoints->leftCols(meeting));
    EXPECT_EQ(path.rightCols(path.cols() - meeting),
              summary.waypoints->rightCols(path.cols() - meeting));
  }
}

TEST(SearchRecorder, TellsTreesInTheOrderInWhichTheyGrew) {
  SearchRecorder recorder;
  const PlanSummary summary = plan(1, &recorder).summary;
  const RecordedSearch search = recorder.search();
  ASSERT_GT(search.nodes.cols(), 10);
  ASSERT_EQ(search.parents.size(), static_cast<std::size_t>(search.nodes.cols()));
  EXPECT_EQ(search.nodes.col(0), kStart);
  EXPECT_EQ(search.parents[0], -1);
  EXPECT_EQ(search.parents[1], -1) << "the goal";
  for (std::size_t i = 2; i < search.parents.size(); ++i) {
    ASSERT_GE(search.parents[i], 0);
    ASSERT_LT(search.parents[i], static_cast<std::int64_t>(i));
    EXPECT_LE((search.nodes.col(static_cast<Eigen::Index>(i)) - search.nodes.col(search.parents[i]))
                  .norm(),
              kStep + 1e-9);
    EXPECT_GE(search.checks[i], search.checks[i - 1]);
  }
  EXPECT_LE(search.checks.back(), summary.collision_checks);
}

TEST(SearchRecorder, HasNoPathThroughANodeThatWasLeftOut) {
  const IsFree is_free = [](const Eigen::VectorXd&) { return true; };
  const PlanningBudget budget(is_free, 1, std::chrono::seconds(1));
  SearchRecorder recorder;
  recorder.begin(budget);
  recorder.add(SearchRecorder::Side::Start, at(0, 0), -1);
  recorder.add(SearchRecorder::Side::Goal, at(1, 1), -1);
  recorder.join(0, 0);
  EXPECT_EQ(recorder.search().path.size(), 2U);
  recorder.begin(budget);
  recorder.add(SearchRecorder::Side::Start, at(0, 0), -1);
  recorder.add(SearchRecorder::Side::Goal, at(1, 1), -1);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(kMaxRecordedNodes); ++i)
    recorder.add(SearchRecorder::Side::Start, at(0, 0), i);
  recorder.join(static_cast<Eigen::Index>(kMaxRecordedNodes), 0);
  EXPECT_TRUE(recorder.search().path.empty());
  EXPECT_EQ(recorder.search().parents.size(), kMaxRecordedNodes);
}

TEST(SearchRecorder, ASecondSearchForgetsTheFirst) {
  SearchRecorder recorder;
  plan(1, &recorder);
  plan(2, &recorder);
  SearchRecorder other;
  plan(2, &other);
  EXPECT_EQ(recorder.search().nodes, other.search().nodes);
  EXPECT_EQ(recorder.search().path, other.search().path);
}

}  // namespace
}  // namespace kinship::planning::search_recorder_test
