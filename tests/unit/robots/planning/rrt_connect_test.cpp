#include "robots/planning/rrt_connect.hpp"

#include <gtest/gtest.h>

#include "robots/planning/tree.hpp"
#include "tests/unit/robots/planning/wall_world.hpp"

namespace kinship::planning::rrt_connect_test {
namespace {

using namespace test_support;

PlanSummary plan(const IsFree& is_free, const Eigen::MatrixXd& goals, std::uint64_t seed,
                 const BirrtOptions& with = stepped()) {
  std::mt19937_64 generator(seed);
  return plan_rrt_connect(kStart, goals, is_free, ConfigurationSampler(square_bounds()), with,
                          generator);
}

TEST(RrtConnect, FindsFreeLinesBetweenTheRightEnds) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    WallWorld world;
    const PlanSummary summary = plan(world.is_free(), kGoal, seed);
    ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
    const Eigen::MatrixXd& path = *summary.waypoints;
    EXPECT_EQ(path.col(0), kStart);
    EXPECT_EQ(path.rightCols(1), kGoal);
    EXPECT_TRUE(world.path_is_free(path, kStep));
    for (Eigen::Index i = 1; i < path.cols(); ++i)
      EXPECT_LE((path.col(i) - path.col(i - 1)).norm(), kConnectRange + 1e-9);
    EXPECT_EQ(summary.found_by, FoundBy::Search);
    EXPECT_EQ(*plan(world.is_free(), kGoal, seed).waypoints, path);
  }
}

TEST(RrtConnect, AFreeStraightLineNeedsNoSearch) {
  WallWorld world;
  Eigen::MatrixXd goals(2, 3);
  goals << kGoal, at(0, 0), at(-0.8, 0.9);
  const PlanSummary summary = plan(world.is_free(), goals, 1);
  ASSERT_TRUE(summary.waypoints);
  EXPECT_EQ(summary.waypoints->cols(), 2);
  EXPECT_EQ(summary.waypoints->rightCols(1), at(-0.8, 0.9));
  EXPECT_EQ(summary.found_by, FoundBy::StraightLine);
  EXPECT_EQ(summary.iterations, 0U);
}

TEST(RrtConnect, TellsWhyThereIsNoPath) {
  WallWorld world;
  EXPECT_EQ(plan(world.is_free(), at(0, 0), 1).reason, NoPath::GoalsCollide);
  EXPECT_EQ(plan(world.is_free(), Eigen::MatrixXd(2, 0), 1).reason, NoPath::NoGoal);
  EXPECT_EQ(plan([](const Eigen::VectorXd&) { return false; }, kGoal, 1).reason,
            NoPath::StartCollides);
  world.gap_upper = world.gap_lower;
  BirrtOptions few = stepped();
  few.max_checks = 500;
  const PlanSummary summary = plan(world.is_free(), kGoal, 1, few);
  EXPECT_EQ(summary.reason, NoPath::MaxChecks);
  EXPECT_FALSE(summary.waypoints);
  EXPECT_LT(summary.collision_checks, 520U);  // a line's last question is asked whole
}

TEST(RrtConnect, WhetherAllAreFreeIsAskedOnceForSeveralConfigurations) {
  WallWorld world;
  std::uint64_t questions = 0;
  const IsFree is_free([&](const Eigen::VectorXd& q) { return world.free_at(q); }, {}, {}, {},
                       [&](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
                         ++questions;
                         for (const auto& q : qs.colwise())
                           if (!world.free_at(q))
                             return false;
                         return true;
                       });
  const PlanSummary summary = plan(is_free, kGoal, 3);
  ASSERT_TRUE(summary.waypoints);
  EXPECT_GT(questions, 0U);
  EXPECT_EQ(*plan(world.is_free(), kGoal, 3).waypoints, *summary.waypoints);
}

TEST(RrtConnect, ARecorderSeesThePathGrow) {
  WallWorld world;
  SearchRecorder recorder;
  BirrtOptions recorded = stepped();
  recorded.recorder = &recorder;
  const PlanSummary summary = plan(world.is_free(), kGoal, 2, recorded);
  ASSERT_TRUE(summary.waypoints);
  const RecordedSearch search = recorder.search();
  ASSERT_EQ(static_cast<Eigen::Index>(search.path.size()), summary.waypoints->cols() + 1);
  EXPECT_EQ(search.nodes.col(search.path.front()), kStart);
  EXPECT_EQ(search.nodes.col(search.path.back()), kGoal);
}

}  // namespace
}  // namespace kinship::planning::rrt_connect_test
