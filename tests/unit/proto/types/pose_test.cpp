#include "proto/types/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace kinship::pose_test {
namespace {

constexpr std::uint64_t kSeed = 20;
constexpr double kPi = 3.14159265358979323846;

Eigen::Isometry3d random_pose(std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const Eigen::Quaterniond q(normal(generator), normal(generator), normal(generator),
                             normal(generator));
  T.linear() = q.normalized().toRotationMatrix();
  T.translation() << normal(generator), normal(generator), normal(generator);
  return T;
}

TEST(Pose, RoundTripsThroughArray) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Isometry3d T = random_pose(generator);
    const auto back = from_pose_array(to_pose_array(T));
    ASSERT_TRUE(back);
    EXPECT_TRUE(back->isApprox(T, 1e-12));
  }
}

TEST(Pose, RefusesWhatIsNoPose) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(from_pose_array({0, 0, nan, 0, 0, 0, 1}));
  EXPECT_FALSE(from_pose_array({1e300, 0, 0, 0, 0, 0, 1}));
  EXPECT_FALSE(from_pose_array({0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(from_pose_array({0, 0, 0, 0, 0, 0, 2}).error().code, ErrorCode::InvalidInput);
}

TEST(Pose, SnappedMovesLessThanACellAndIsIdempotent) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Isometry3d T = random_pose(generator);
    const Eigen::Isometry3d once = snapped(T);
    EXPECT_LT((once.translation() - T.translation()).cwiseAbs().maxCoeff(), 0.5001e-3);
    EXPECT_LT(Eigen::AngleAxisd(once.linear().transpose() * T.linear()).angle(), 1e-3);
    EXPECT_TRUE(snapped(once).isApprox(once, 1e-12));
  }
}

TEST(Pose, SnappedKnowsAHalfTurnFromBothSides) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d axis = random_pose(generator).linear().col(0);
    Eigen::Isometry3d below = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d above = Eigen::Isometry3d::Identity();
    below.linear() = Eigen::AngleAxisd(kPi - 1e-9, axis).toRotationMatrix();
    above.linear() = Eigen::AngleAxisd(kPi + 1e-9, axis).toRotationMatrix();
    EXPECT_TRUE(snapped(below).isApprox(snapped(above), 1e-9)) << axis.transpose();
  }
}

}  // namespace
}  // namespace kinship::pose_test
