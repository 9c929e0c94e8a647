#include "server/transfer/transfer.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <stdexcept>

#include "robots/inverse/inverse.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/resample.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/transfer_path.hpp"

namespace kinship::transfer::transfer_test {
namespace {

using kinematics::resample;
using test::planar_pose;
using test::PlanarArm;
using test::transfer_path;

constexpr std::uint64_t kSeed = 11;

kinematics::Chain source_arm() {
  return PlanarArm{.lengths_m = {0.25, 0.25, 0.2, 0.15, 0.15}, .limit = 2.8}.chain();
}
kinematics::Chain target_arm() {
  return PlanarArm{.lengths_m = {0.18, 0.17, 0.16, 0.15, 0.13, 0.11, 0.1}, .limit = 2.8}.chain();
}

Path source_path() {
  Eigen::MatrixXd waypoints(5, 3);
  waypoints << 0.3, 1.2, 1.5, 0.5, -0.8, -1, 0.4, 0.6, 1.2, -0.6, 0.3, 0.5, 0.2, 0.9, 0.1;
  return Path(waypoints);
}

std::uint64_t reasons(const TransferCounts& summary) {
  return summary.out_of_reach + summary.outside_limits + summary.not_converged;
}

/// Largest distance of a configuration's transfer frame from the source's, as the target sees it.
double largest_error(const TransferredPath& transferred, const kinematics::Chain& source,
                     const kinematics::Chain& target, const Eigen::Isometry3d& T_target_source,
                     const Eigen::MatrixXd& resampled) {
  double worst = 0;
  for (Eigen::Index i = 0; i < transferred.configurations.cols(); ++i) {
    const Eigen::Isometry3d T_wanted =
        T_target_source *
        kinematics::T_base_transfer(source, resampled.col(transferred.pose_index[i]));
    const Eigen::Isometry3d T_actual =
        kinematics::T_base_transfer(target, transferred.configurations.col(i));
    worst = std::max(worst, (T_wanted.matrix() - T_actual.matrix()).cwiseAbs().maxCoeff());
  }
  return worst;
}

TEST(Transfer, TheSameRobotAtTheSamePlaceTakesItsWaypointsOver) {
  const auto arm = source_arm();
  const Path path = source_path();
  const auto transferred =
      transfer_path(path, {arm, arm}, Eigen::Isometry3d::Identity(), {}, kSeed);
  EXPECT_EQ(transferred.configurations, resample(path, {}));
  EXPECT_TRUE((transferred.solution_index.array() == 0).all());
  EXPECT_EQ(transferred.pose_index[1], 1);
  EXPECT_EQ(transferred.summary.poses_solved, transferred.summary.poses);
  EXPECT_EQ(transferred.summary.configurations, transferred.summary.poses);
}

TEST(Transfer, TheSameRobotGoesThroughInverseKinematicsWhereThatIsWanted) {
  const auto arm = source_arm();
  const Eigen::Isometry3d same = Eigen::Isometry3d::Identity();
  const TransferParameters parameters{.take_over = false};
  const auto transferred = transfer_path(source_path(), {arm, arm}, same, parameters, kSeed);
  EXPECT_GT(transferred.summary.configurations, transferred.summary.poses);
  EXPECT_GT(transferred.summary.tracks_kept, 0U);
  EXPECT_LT(largest_error(transferred, arm, arm, same, resample(source_path(), parameters)), 2e-6);
}

TEST(Transfer, TheSameRobotElsewhereIsTransferred) {
  const auto arm = source_arm();
  const auto transferred =
      transfer_path(source_path(), {arm, arm}, planar_pose(0.001, 0, 0), {}, kSeed);
  EXPECT_GT(transferred.summary.configurations, transferred.summary.poses);
}

TEST(Transfer, SummaryAndIndicesAddUp) {
  const auto short_arm = PlanarArm{.lengths_m = {0.4, 0.3, 0.2, 0.1}, .limit = 1.5}.chain();
  const auto transferred = transfer_path(source_path(), {source_arm(), short_arm},
                                         planar_pose(0.1, 0, 0), {.pose_spacing = 0.05}, kSeed);
  const TransferCounts& summary = transferred.summary;
  EXPECT_GT(summary.poses_solved, 0U);
  EXPECT_GT(reasons(summary), 0U);
  EXPECT_EQ(summary.poses, summary.poses_solved + reasons(summary));
  const auto count = static_cast<Eigen::Index>(summary.configurations);
  ASSERT_EQ(transferred.configurations.cols(), count);
  ASSERT_EQ(transferred.pose_index.size(), count);
  EXPECT_EQ(transferred.weights, Eigen::VectorXd::Ones(count));

  std::uint64_t poses_seen = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const bool first = i == 0 || transferred.pose_index[i] > transferred.pose_index[i - 1];
    EXPECT_EQ(transferred.solution_index[i], first ? 0 : transferred.solution_index[i - 1] + 1);
    poses_seen += first ? 1 : 0;
  }
  EXPECT_EQ(poses_seen, summary.poses_solved);
}

TEST(Transfer, AnUnreachablePathIsAnAnswer) {
  const auto transferred =
      transfer_path(source_path(), {source_arm(), target_arm()}, planar_pose(5, 0, 0), {}, kSeed);
  EXPECT_EQ(transferred.configurations.cols(), 0);
  EXPECT_EQ(transferred.configurations.rows(), 7);
  EXPECT_EQ(transferred.summary.out_of_reach, transferred.summary.poses);
}

TEST(Transfer, EqualInputAndSeedGiveEqualBytes) {
  const auto run = [](std::uint64_t seed) {
    return transfer_path(source_path(), {source_arm(), target_arm()}, planar_pose(0.1, 0, 0), {},
                         seed);
  };
  EXPECT_EQ(run(1).configurations, run(1).configurations);
  EXPECT_NE(run(1).configurations, run(2).configurations);
}

TEST(Transfer, GivesAtMostLRandomSolutionsAtLeastDApart) {
  const TransferParameters parameters{.max_solutions = 3, .min_distance = 1.5, .tracks = 0};
  const auto transferred = transfer_path(source_path(), {source_arm(), target_arm()},
                                         planar_pose(0, 0, 0), parameters, kSeed);
  EXPECT_LT(transferred.solution_index.maxCoeff(), 3);
  for (Eigen::Index i = 1; i < transferred.configurations.cols(); ++i)
    if (transferred.pose_index[i] == transferred.pose_index[i - 1]) {
      EXPECT_GE((transferred.configurations.col(i) - transferred.configurations.col(i - 1)).norm(),
                1.5);
    }
}

TEST(Transfer, RefusesAPathOfAnotherRobot) {
  EXPECT_THROW(
      transfer_path(source_path(), {target_arm(), source_arm()}, planar_pose(0, 0, 0), {}, kSeed),
      std::invalid_argument);
}

TEST(Transfer, OwnContinuousJointsAreTurnedToWhereSamplesLie) {
  const auto arm =
      PlanarArm{.lengths_m = {0.3, 0.2}, .type = kinematics::JointType::Continuous}.chain();
  Eigen::MatrixXd waypoints(2, 2);
  waypoints << 3, 8, -40, -41;
  const Eigen::Isometry3d same = Eigen::Isometry3d::Identity();
  const auto transferred = transfer_path(Path(waypoints), {arm, arm}, same, {}, kSeed);
  EXPECT_LE(transferred.configurations.cwiseAbs().maxCoeff(), std::numbers::pi);
  EXPECT_LT(largest_error(transferred, arm, arm, same, resample(Path(waypoints), {})), 1e-12);
}

}  // namespace
}  // namespace kinship::transfer::transfer_test
