#include "robots/inverse/inverse.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "robots/inverse/joint_space.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/joint_distance.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"

namespace kinship::inverse::inverse_test {
namespace {

using kinematics::JointType;
using test::distance;
using test::planar_pose;
using test::PlanarArm;
constexpr double kPi = std::numbers::pi;

bool contains(const InverseSolutions& solutions, const Eigen::VectorXd& q) {
  return ((solutions.configurations.colwise() - q).colwise().norm().array() < 1e-5).any();
}

TEST(Inverse, FindsBothElbowsOfATwoJointArm) {
  const auto chain = PlanarArm{.lengths_m = {1, 1}, .yaw = false}.chain();
  const auto solutions = inverse(chain, planar_pose(1, 1, 0));
  ASSERT_EQ(solutions.configurations.cols(), 2);
  EXPECT_TRUE(contains(solutions, Eigen::Vector2d(0, kPi / 2)));
  EXPECT_TRUE(contains(solutions, Eigen::Vector2d(kPi / 2, -kPi / 2)));
  EXPECT_EQ(solutions.reason, NoSolution::None);
}

TEST(Inverse, FindsBothBranchesOfAThreeJointArmWithYaw) {
  const auto chain = PlanarArm{.lengths_m = {0.5, 0.4, 0.2}, .limit = 3}.chain();
  const Eigen::Vector3d q(0.3, 0.8, -0.5);
  const auto solutions = inverse(chain, kinematics::T_base_tip(chain, q), {.max_solutions = 0});
  ASSERT_EQ(solutions.configurations.cols(), 2);
  EXPECT_TRUE(contains(solutions, q));
}

TEST(Inverse, RedundantArmFillsUpToLAtLeastDApart) {
  const auto chain = PlanarArm{.lengths_m = {0.3, 0.25, 0.2, 0.15, 0.1}, .limit = 2.5}.chain();
  const auto solutions =
      inverse(chain, planar_pose(0.5, 0.3, 0.8), {.max_solutions = 12, .min_distance = 0.5});
  ASSERT_EQ(solutions.configurations.cols(), 12);
  for (Eigen::Index a = 0; a < 12; ++a)
    for (Eigen::Index b = 0; b < a; ++b)
      EXPECT_GE(distance(chain, solutions.configurations.col(a), solutions.configurations.col(b)),
                0.5);
}

TEST(Inverse, WithoutADistanceTheSameSolutionStillCountsOnce) {
  const auto chain = PlanarArm{.lengths_m = {1, 1}, .yaw = false}.chain();
  const auto solutions = inverse(chain, planar_pose(1, 1, 0), {.min_distance = 0});
  EXPECT_EQ(solutions.configurations.cols(), 2);
}

TEST(Inverse, EqualSeedAndPoseGiveEqualBytesOthersDiffer) {
  const auto chain = PlanarArm{.lengths_m = {0.4, 0.3, 0.2, 0.1}, .limit = 2.5}.chain();
  const Eigen::Isometry3d T = planar_pose(0.5, 0.3, 0.8);
  const Eigen::MatrixXd first = inverse(chain, T, {.seed = 1}).configurations;
  EXPECT_EQ(first, inverse(chain, T, {.seed = 1}).configurations);
  EXPECT_NE(first, inverse(chain, T, {.seed = 2}).configurations);
}

TEST(Inverse, DistanceIsWrappedForContinuousJointsOnly) {
  PlanarArm arm{.lengths_m = {1, 1}, .yaw = false};
  const Eigen::Isometry3d T = planar_pose(-1.99, 0, 0);  // q = +-(pi - 0.1, 0.2)
  const InverseOptions options{.max_solutions = 0, .min_distance = 0.5};
  EXPECT_EQ(inverse(arm.chain(), T, options).configurations.cols(), 2);
  arm.type = JointType::Continuous;
  const auto solutions = inverse(arm.chain(), T, options);
  ASSERT_EQ(solutions.configurations.cols(), 1);
  EXPECT_LE(solutions.configurations.cwiseAbs().maxCoeff(), kPi);
}

TEST(Inverse, RefusesWhatIsNoQuestion) {
  const auto chain = PlanarArm{.lengths_m = {1, 1}}.chain();
  Eigen::Isometry3d T = planar_pose(1, 1, 0);
  EXPECT_THROW(inverse(chain, T, {.max_solutions = -1}), std::invalid_argument);
  EXPECT_THROW(inverse(chain, T, {.min_distance = -0.1}), std::invalid_argument);
  T.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(inverse(chain, T), std::invalid_argument);
}

/// Branches of six turning joints come in pairs: an odd number of them means that one is missing.
/// Limits of a whole turn leave none out.
TEST(Inverse, SixJointsOfAnyKindReachAPoseInPairs) {
  std::mt19937_64 generator(6);
  int odd = 0;
  for (int arm = 0; arm < 4; ++arm) {
    const kinematics::Chain chain = test::random_chain({}, generator);
    const Solver solver(chain);
    for (int pose = 0; pose < 30; ++pose) {
      const Eigen::VectorXd q = test::random_configuration(chain, generator);
      const InverseSolutions found =
          solver.solve(kinematics::T_base_tip(chain, q), {.max_solutions = 64, .min_distance = 0});
      odd += found.configurations.cols() % 2 == 0 ? 0 : 1;
      EXPECT_GT(found.configurations.cols(), 0);
    }
  }
  EXPECT_LE(odd, 1);
}

}  // namespace
}  // namespace kinship::inverse::inverse_test
