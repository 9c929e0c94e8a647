#include "robots/planning/experience_guide.hpp"

#include <gtest/gtest.h>

namespace kinship::planning::moved_path_test {
namespace {

Eigen::Isometry3d pose(double x, double y, double z, double turn) {
  return Eigen::Translation3d(x, y, z) *
         Eigen::AngleAxisd(turn, Eigen::Vector3d(1, 2, 3).normalized());
}

PosePath arc() {
  PosePath path;
  for (int i = 0; i <= 8; ++i)
    path.poses.push_back(pose(0.1 * i, 0.02 * i * (8 - i), 0.3, 0.2 * i));
  return path;
}

TEST(MovedPath, EndsAreThoseOfTheQuery) {
  const PoseQuery query{pose(0.4, -1, 0.2, 1.1), pose(-0.3, 0.5, 0.9, -2)};
  const auto moved = moved_onto(arc(), query);
  ASSERT_EQ(moved.size(), arc().poses.size());
  EXPECT_TRUE(moved.front().isApprox(query.T_task_start, 1e-9));
  EXPECT_TRUE(moved.back().isApprox(query.T_task_goal, 1e-9));
}

TEST(MovedPath, AQueryThatIsThePathsOwnLeavesIt) {
  const PosePath path = arc();
  const auto moved = moved_onto(path, {path.poses.front(), path.poses.back()});
  for (std::size_t i = 0; i < path.poses.size(); ++i)
    EXPECT_TRUE(moved[i].isApprox(path.poses[i], 1e-9)) << i;
}

TEST(MovedPath, AQueryMovedAsAWholeMovesThePathWithIt) {
  const PosePath path = arc();
  const Eigen::Isometry3d by = pose(0.2, 0.7, -0.1, 0.8);
  const auto moved = moved_onto(path, {by * path.poses.front(), by * path.poses.back()});
  for (std::size_t i = 0; i < path.poses.size(); ++i) {
    EXPECT_TRUE(moved[i].isApprox(by * path.poses[i], 1e-9)) << i;
    EXPECT_NEAR(moved[i].linear().determinant(), 1, 1e-9);
  }
}

TEST(MovedPath, NearTheGoalThePathKeepsItsWayRelativeToIt) {
  const PosePath path = arc();
  const Eigen::Isometry3d goal = pose(0.3, -0.4, 0.5, 0.6);
  const auto moved = moved_onto(path, {path.poses.front(), goal});
  const std::size_t before = path.poses.size() - 2;
  const Eigen::Isometry3d wanted = goal * path.poses.back().inverse() * path.poses[before];
  const Eigen::Isometry3d stored = path.poses[before];
  EXPECT_LT(pose_distance_m(moved[before], wanted), 1e-9);
  EXPECT_GT(pose_distance_m(stored, wanted), 0.1);
}

TEST(MovedPath, TheNearestPathsComeFirst) {
  std::vector<PosePath> paths(4, arc());
  const double away[] = {0.5, 0.1, 0.3, 0.1};
  for (std::size_t i = 0; i < 4; ++i)
    paths[i].poses.back().translation().x() += away[i];
  const PoseQuery query{arc().poses.front(), arc().poses.back()};
  EXPECT_EQ(nearest_paths(paths, query, 3), (std::vector<std::size_t>{1, 3, 2}));
  EXPECT_EQ(nearest_paths(paths, query, 9).size(), 4U);
  EXPECT_TRUE(nearest_paths({}, query, 3).empty());
}

TEST(MovedPath, ARetreatComesAlongThePalmAndAStraightWayDoesNotTurnBack) {
  const PoseQuery query{pose(0, 0, 0, 0), pose(1, 0, 0, 0.5)};
  const auto along = moved_onto(retreat(0.4), query);
  const std::size_t half = along.size() / 2;
  const Eigen::Vector3d before = query.T_task_goal.inverse() * along[half].translation();
  EXPECT_TRUE(before.isApprox(Eigen::Vector3d(0, 0, before.z()), 1e-6)) << before.transpose();
  EXPECT_LT(before.z(), -0.35);
  EXPECT_TRUE(along.front().isApprox(query.T_task_start, 1e-9));
  for (const Eigen::Isometry3d& straight : moved_onto(retreat(0), query))
    EXPECT_NEAR(straight.translation().tail<2>().norm(), 0, 1e-9);
}

TEST(MovedPath, ARadianCountsAs30Centimetres) {
  EXPECT_NEAR(pose_distance_m(pose(0, 0, 0, 0), pose(0.3, 0.4, 0, 1)), 0.5 + 0.3, 1e-9);
}

}  // namespace
}  // namespace kinship::planning::moved_path_test
