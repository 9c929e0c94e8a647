#include "robots/kinematics/timed_path.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace kinship::kinematics {
namespace {

using namespace std::chrono_literals;

Path bent_path() {
  Eigen::MatrixXd waypoints(2, 4);
  waypoints << 0, 1, 1, 0,  //
      0, 0, 0, 3;
  return Path(waypoints);
}

TEST(TimedPath, TheSlowestJointOfEachSegmentMovesAtItsSpeed) {
  const TimedPath path = timed(bent_path(), Eigen::Vector2d(2, 1), 1e-9);

  // The waypoint that repeats the one before takes no time.
  EXPECT_EQ(path.times, (std::vector<std::chrono::nanoseconds>{0s, 500ms, 3500ms}));
  ASSERT_EQ(path.configurations.cols(), 3);
  EXPECT_EQ(path.configurations.col(1), Eigen::Vector2d(1, 0));
  EXPECT_EQ(path.configurations.col(2), Eigen::Vector2d(0, 3));
}

TEST(TimedPath, ConfigurationsBetweenWaypointsLieOnTheLine) {
  const TimedPath path = timed(bent_path(), Eigen::Vector2d(2, 1), 10);

  ASSERT_EQ(path.times.size(), 1U + 5 + 30);
  ASSERT_EQ(path.configurations.cols(), 36);
  EXPECT_EQ(path.times[2], 200ms);
  EXPECT_TRUE(path.configurations.col(2).isApprox(Eigen::Vector2d(0.4, 0)));
  EXPECT_EQ(path.times[20], 2s);
  EXPECT_TRUE(path.configurations.col(20).isApprox(Eigen::Vector2d(0.5, 1.5)));
}

TEST(TimedPath, APathWithoutMotionIsOneConfiguration) {
  const TimedPath path = timed(Path(Eigen::MatrixXd::Ones(3, 5)), Eigen::Vector3d::Ones(), 30);

  EXPECT_EQ(path.times, std::vector<std::chrono::nanoseconds>{0ns});
  EXPECT_EQ(path.configurations, Eigen::MatrixXd::Ones(3, 1));
}

TEST(TimedPath, RefusesSpeedsOfAnotherRobot) {
  EXPECT_THROW(timed(bent_path(), Eigen::Vector3d::Ones(), 30), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::kinematics
