#include "server/transfer/take_over.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "robots/kinematics/resample.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/transfer_path.hpp"

namespace kinship::transfer::take_over_test {
namespace {

using kinematics::ArmLikeness;
using kinematics::JointType;
using kinematics::resample;
using test::planar_pose;
using test::PlanarArm;
using test::transfer_path;

constexpr double kTurn = 2 * std::numbers::pi;
constexpr std::uint64_t kSeed = 3;

kinematics::Chain arm(double limit = 2.8, JointType type = JointType::Revolute) {
  return PlanarArm{.lengths_m = {0.4, 0.3, 0.2}, .limit = limit, .type = type}.chain();
}
/// Its second link is `longer_m` longer, the transfer frame sits as before.
kinematics::Chain stretched(double longer_m) {
  return PlanarArm{.lengths_m = {0.4, 0.3 + longer_m, 0.2}, .limit = 2.8}.chain();
}

Eigen::VectorXd brought(const kinematics::Chain& robot, Eigen::Vector3d q, bool* inside) {
  *inside = bring_within(robot, q);
  return q;
}

TEST(BringWithin, LeavesWhatIsInside) {
  bool inside = false;
  const Eigen::Vector3d q(2.8, -2.8, 0.1);
  EXPECT_EQ(brought(arm(), q, &inside), q);
  EXPECT_TRUE(inside);
}

TEST(BringWithin, MovesRoundingOntoTheLimit) {
  bool inside = false;
  EXPECT_EQ(brought(arm(), {2.8 + 9e-7, -2.8 - 9e-7, 0}, &inside), Eigen::Vector3d(2.8, -2.8, 0));
  EXPECT_TRUE(inside);
  brought(arm(), {2.8 + 1.1e-6, 0, 0}, &inside);
  EXPECT_FALSE(inside);
}

TEST(BringWithin, TurnsByWholeTurnsOnlyWhatIsOutside) {
  bool inside = false;
  EXPECT_NEAR(brought(arm(), {0.5 + kTurn, 0, 0}, &inside)[0], 0.5, 1e-12);
  EXPECT_TRUE(inside);
  EXPECT_EQ(brought(arm(7), {6.5, 0, 0}, &inside)[0], 6.5);
  EXPECT_NEAR(brought(arm(7, JointType::Continuous), {6.5, 0, 0}, &inside)[0], 6.5 - kTurn, 1e-12);
  EXPECT_TRUE(inside);
  brought(arm(), {3.0, 0, 0}, &inside);
  EXPECT_FALSE(inside);
}

TEST(BringWithin, ASlideHasNoTurns) {
  bool inside = false;
  brought(arm(1, JointType::Prismatic), {0.5 + kTurn, 0, 0}, &inside);
  EXPECT_FALSE(inside);
}

Path path() {
  Eigen::MatrixXd waypoints(3, 3);
  waypoints << 0.3, 1.2, 1.5, 0.5, 0.8, 1, 0.4, 0.6, 1.2;
  return Path(waypoints);
}

TransferredPath transferred(const kinematics::Chain& source, const kinematics::Chain& target) {
  return transfer_path(path(), {source, target}, Eigen::Isometry3d::Identity(), {}, kSeed);
}

TEST(TakeOver, OfAnExactTwinGivesTheWaypointsThemselves) {
  const auto result = transferred(arm(2.8), arm(3.1));
  EXPECT_EQ(result.configurations, resample(path(), {}));
  EXPECT_EQ(result.summary.poses_solved, result.summary.poses);
}

TEST(TakeOver, WhatTheTargetsLimitsForbidIsCounted) {
  const auto source = arm(2.8);
  const auto target = arm(1.0);
  const auto result = transferred(source, target);
  const Eigen::MatrixXd resampled = resample(path(), {});
  const auto outside = (resampled.colwise().maxCoeff().array() > 1.0).count();
  ASSERT_GT(outside, 0);
  ASSERT_LT(outside, resampled.cols());
  EXPECT_EQ(result.summary.outside_limits, static_cast<std::uint64_t>(outside));
  EXPECT_EQ(result.summary.poses, result.summary.poses_solved + result.summary.outside_limits);
  ASSERT_EQ(result.configurations.cols(), resampled.cols() - outside);
  for (Eigen::Index i = 0; i < result.configurations.cols(); ++i)
    EXPECT_EQ(result.configurations.col(i), resampled.col(result.pose_index[i]));
  EXPECT_EQ(result.weights.size(), result.configurations.cols());
  EXPECT_EQ(result.solution_index.size(), result.configurations.cols());
}

TEST(TakeOver, OfANearTwinIsPolishedFromTheWaypointItself) {
  const auto source = arm();
  const auto target = stretched(0.003);
  ASSERT_EQ(ArmPair(source, target).likeness(), ArmLikeness::Near);
  const auto result = transferred(source, target);
  const Eigen::MatrixXd resampled = resample(path(), {});
  ASSERT_EQ(result.configurations.cols(), resampled.cols());
  const double moved = (result.configurations - resampled).colwise().norm().maxCoeff();
  EXPECT_GT(moved, 1e-4);
  EXPECT_LT(moved, 0.05);
}

TEST(TakeOver, APoseOnlyTheLongerArmReachesHasNotConverged) {
  const auto source = stretched(0.003);
  const auto target = arm();
  const ArmPair pair(source, target);
  const auto result = take_over(Eigen::Vector3d(0.3, 0, 0), pair);
  EXPECT_EQ(result.configurations.cols(), 0);
  EXPECT_EQ(result.configurations.rows(), 3);
  EXPECT_EQ(result.summary.not_converged, 1U);
}

TEST(TakeOver, APolishThatEndsFarAwayIsNoTakeOver) {
  const auto source = arm();
  const auto target = stretched(0.004);
  const ArmPair pair(source, target);
  // Stretched out the target must fold its elbow by about 0.3 rad for 4 mm less.
  const auto result = take_over(Eigen::Vector3d(0.3, 0.01, 0.01), pair);
  EXPECT_EQ(result.summary.not_converged, 1U);
}

TEST(TakeOver, NeedsTheSamePlaceAndTheSameArm) {
  const auto source = arm();
  const auto twin = stretched(0.003);
  const auto other = stretched(0.05);
  EXPECT_TRUE(ArmPair(source, twin).takes_over(planar_pose(0, 0, 1e-10)));
  EXPECT_FALSE(ArmPair(source, twin).takes_over(planar_pose(0.001, 0, 0)));
  EXPECT_FALSE(ArmPair(source, other).takes_over(planar_pose(0, 0, 0)));
}

}  // namespace
}  // namespace kinship::transfer::take_over_test
