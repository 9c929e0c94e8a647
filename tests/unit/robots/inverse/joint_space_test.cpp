#include "robots/inverse/joint_space.hpp"

#include <gtest/gtest.h>

#include "robots/inverse/choice.hpp"

#include "tests/support/joint_distance.hpp"
#include "tests/support/planar_arm.hpp"

namespace kinship::inverse::joint_space_test {
namespace {

using kinematics::JointType;
using test::distance;
using test::normalize;
using test::PlanarArm;
constexpr double kPi = std::numbers::pi;

TEST(Normalize, OfTurnedCopiesTheOneNearestMidRangeStands) {
  const auto chain = PlanarArm{.lengths_m = {1, 1}, .limit = 2 * kPi}.chain();
  Eigen::VectorXd q = Eigen::Vector2d(1.5 * kPi, -5 * kPi + 0.1);
  EXPECT_TRUE(normalize(chain, q));
  EXPECT_NEAR(q[0], -0.5 * kPi, 1e-12);
  EXPECT_NEAR(q[1], -kPi + 0.1, 1e-12);
}

TEST(Normalize, ContinuousJointsLieInTheHalfOpenTurn) {
  const auto chain =
      PlanarArm{.lengths_m = {1, 1, 1}, .limit = kPi, .type = JointType::Continuous}.chain();
  Eigen::VectorXd q = Eigen::Vector3d(-kPi, 7 * kPi / 2, kPi);
  EXPECT_TRUE(normalize(chain, q));
  EXPECT_TRUE(q.isApprox(Eigen::Vector3d(kPi, -kPi / 2, kPi), 1e-12));
}

TEST(Normalize, NoCopyWithinLimitsIsOutside) {
  const auto chain = PlanarArm{.lengths_m = {1, 1}, .limit = 2}.chain();
  Eigen::VectorXd q = Eigen::Vector2d(0, 3);
  EXPECT_FALSE(normalize(chain, q));
  q = Eigen::Vector2d(2 * kPi, -1.9 - 4 * kPi);
  EXPECT_TRUE(normalize(chain, q));
}

TEST(Normalize, RoundingBeyondALimitIsMovedOntoIt) {
  const auto chain = PlanarArm{.lengths_m = {1}, .limit = 2}.chain();
  Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 2 + 1e-12);
  EXPECT_TRUE(normalize(chain, q));
  EXPECT_EQ(q[0], 2);
}

TEST(Normalize, PrismaticJointsDoNotTurn) {
  const auto chain = PlanarArm{.lengths_m = {1}, .limit = 2, .type = JointType::Prismatic}.chain();
  Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 2 * kPi);
  EXPECT_FALSE(normalize(chain, q));
  EXPECT_EQ(q[0], 2 * kPi);
}

TEST(Distance, IsEuclideanAndWrappedForContinuousJointsOnly) {
  const Eigen::Vector2d a(3, 0);
  const Eigen::Vector2d b(-3, 4);
  const auto limited = PlanarArm{.lengths_m = {1, 1}, .limit = 5}.chain();
  EXPECT_NEAR(distance(limited, a, b), std::hypot(6, 4), 1e-12);
  const auto continuous =
      PlanarArm{.lengths_m = {1, 1}, .limit = kPi, .type = JointType::Continuous}.chain();
  EXPECT_NEAR(distance(continuous, a, b), std::hypot(2 * kPi - 6, 2 * kPi - 4), 1e-12);
}

TEST(Chosen, IsUniformAndApart) {
  const auto chain = PlanarArm{.lengths_m = {1}, .limit = 5}.chain();
  const JointSpace space(chain);
  Configurations all(1);
  for (const double value : {0.0, 1.0, 1.05, 3.0})
    all.add(&value);
  constexpr int kDraws = 4000;
  Eigen::Vector4d first = Eigen::Vector4d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const CounterGenerator generator =
        CounterGenerator(7).of_attempt(static_cast<std::uint64_t>(i));
    const Eigen::MatrixXd taken = chosen(space, all, 8, 0.2, generator).matrix();
    EXPECT_EQ(taken.cols(), 3);  // not both 1 and 1.05
    for (int k = 0; k < 4; ++k)
      first[k] += taken(0, 0) == *all[static_cast<std::size_t>(k)] ? 1 : 0;
  }
  EXPECT_LT((first / kDraws - Eigen::Vector4d::Constant(0.25)).cwiseAbs().maxCoeff(), 0.03);
}

}  // namespace
}  // namespace kinship::inverse::joint_space_test
