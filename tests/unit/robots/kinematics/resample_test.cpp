#include "robots/kinematics/resample.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <stdexcept>

#include "proto/types/limits.hpp"

namespace kinship::kinematics::resample_test {
namespace {

constexpr std::uint64_t kSeed = 4;

Path straight(double length) {
  Eigen::MatrixXd waypoints(2, 2);
  waypoints << 0, length, 1, 1;
  return Path(waypoints);
}

Path random_path(Eigen::Index dof, Eigen::Index size) {
  std::mt19937_64 generator(kSeed);
  std::uniform_real_distribution<double> joint(-2, 2);
  return Path(Eigen::MatrixXd::NullaryExpr(dof, size, [&] { return joint(generator); }));
}

const TransferParameters kWhole{.pose_spacing = 0.3, .dropped_end_share = 0};

TEST(Resample, CutsALineIntoEqualIntervalsBothEndsIncluded) {
  const Eigen::MatrixXd resampled = resample(straight(3), kWhole);
  ASSERT_EQ(resampled.cols(), 11);
  EXPECT_TRUE(resampled.row(0).isApprox(Eigen::RowVectorXd::LinSpaced(11, 0, 3), 1e-12));
  EXPECT_TRUE((resampled.row(1).array() == 1).all());
}

TEST(Resample, IntervalsAreNeverLongerThanTheSpacing) {
  EXPECT_EQ(resample(straight(3.01), kWhole).cols(), 12);
  EXPECT_EQ(resample(straight(0.1), kWhole).cols(), 2);
}

TEST(Resample, DistanceRunsAlongThePolyline) {
  Eigen::MatrixXd waypoints(2, 3);
  waypoints << 0, 1, 1, 0, 0, 1;
  const Eigen::MatrixXd resampled =
      resample(Path(waypoints), {.pose_spacing = 0.5, .dropped_end_share = 0});
  Eigen::MatrixXd expected(2, 5);
  expected << 0, 0.5, 1, 1, 1, 0, 0, 0, 0.5, 1;
  EXPECT_TRUE(resampled.isApprox(expected, 1e-12));
}

TEST(Resample, DoesNotDependOnHowDenselyThePathWasWritten) {
  const Path sparse = random_path(5, 6);
  Eigen::MatrixXd dense(5, 51);
  for (Eigen::Index i = 0; i < 51; ++i) {
    const Eigen::Index from = std::min<Eigen::Index>(i / 10, 4);
    const double share = static_cast<double>(i - 10 * from) / 10;
    dense.col(i) =
        (1 - share) * sparse.waypoints().col(from) + share * sparse.waypoints().col(from + 1);
  }
  EXPECT_TRUE(resample(Path(dense), {}).isApprox(resample(sparse, {}), 1e-9));
}

TEST(Resample, DropsTheShareOfTheLengthAtEachEnd) {
  const Eigen::MatrixXd resampled =
      resample(straight(10), {.pose_spacing = 0.5, .dropped_end_share = 0.15});
  EXPECT_EQ(resampled.cols(), 15);
  EXPECT_NEAR(resampled(0, 0), 1.5, 1e-12);
  EXPECT_NEAR(resampled(0, 14), 8.5, 1e-12);
}

TEST(Resample, DroppingEverythingLeavesTheMiddle) {
  const Eigen::MatrixXd resampled = resample(straight(4), {.dropped_end_share = 0.5});
  ASSERT_EQ(resampled.cols(), 1);
  EXPECT_NEAR(resampled(0, 0), 2, 1e-12);
}

TEST(Resample, TheCapStretchesTheIntervalsEvenly) {
  const Eigen::MatrixXd resampled = resample(
      straight(30), {.pose_spacing = 0.3, .max_poses_per_path = 4, .dropped_end_share = 0});
  EXPECT_TRUE(resampled.row(0).isApprox(Eigen::RowVector4d(0, 10, 20, 30), 1e-12));
}

TEST(Resample, WithoutACapItStopsAtTheMostWaypointsOfAPath) {
  const TransferParameters tiny{
      .pose_spacing = 1e-9, .max_poses_per_path = 0, .dropped_end_share = 0};
  EXPECT_EQ(resample(straight(100), tiny).cols(), static_cast<Eigen::Index>(kMaxWaypoints));
}

TEST(Resample, APathWithoutMotionIsOneConfiguration) {
  EXPECT_EQ(resample(Path(Eigen::MatrixXd::Ones(3, 5)), {}), Eigen::MatrixXd::Ones(3, 1));
}

TEST(Resample, RepeatedWaypointsAreHarmless) {
  Eigen::MatrixXd waypoints(1, 6);
  waypoints << 0, 0, 1, 1, 2, 2;
  EXPECT_TRUE(resample(Path(waypoints), {.pose_spacing = 0.5, .dropped_end_share = 0})
                  .isApprox(Eigen::RowVectorXd::LinSpaced(5, 0, 2), 1e-12));
}

TEST(Resample, RefusesParametersWithoutMeaning) {
  const Path path = straight(1);
  EXPECT_THROW(resample(path, {.pose_spacing = 0}), std::invalid_argument);
  EXPECT_THROW(resample(path, {.max_poses_per_path = -1}), std::invalid_argument);
  EXPECT_THROW(resample(path, {.dropped_end_share = 0.51}), std::invalid_argument);
  EXPECT_THROW(resample(path, {.dropped_end_share = -0.1}), std::invalid_argument);
}

TEST(Resample, RefusesALengthThatOverflows) {
  Eigen::MatrixXd waypoints(1, 2);
  waypoints << -1e308, 1e308;
  EXPECT_THROW(resample(Path(waypoints), {}), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::kinematics::resample_test
