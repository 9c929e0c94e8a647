#include "robots/inverse/joint_space.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "robots/inverse/counter_generator.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/inverse/search.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
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

using test::planar_axes;
using test::planar_pose;

TEST(TaskError, IsZeroBetweenEqualPosesAndTwiceTheHalfSineOtherwise) {
  const TaskAxes all;
  const Eigen::Isometry3d T = planar_pose(0.3, -0.2, 1);
  EXPECT_LT(task_error(T, T, all).norm(), 1e-15);
  const TaskError error = task_error(planar_pose(0.3, -0.2, 1.4), T, all);
  EXPECT_NEAR(error[5], 2 * std::sin(0.2), 1e-12);
  EXPECT_LT(error.head<5>().norm(), 1e-12);
}

TEST(TaskError, StaysLargestAtHalfATurn) {
  const TaskError error =
      task_error(planar_pose(0, 0, kPi), Eigen::Isometry3d::Identity(), TaskAxes{});
  EXPECT_NEAR(error.norm(), 2, 1e-9);
}

TEST(TaskError, IgnoresAxesThatDoNotMatter) {
  Eigen::Isometry3d tilted = planar_pose(1, 2, 0.5);
  tilted.translation().z() = 9;
  EXPECT_LT(task_error(tilted, planar_pose(1, 2, -0.5), planar_axes(false)).norm(), 1e-12);
  EXPECT_NEAR(task_error(tilted, planar_pose(1, 2, -0.5), planar_axes(true)).norm(),
              2 * std::sin(0.5), 1e-12);
}

TEST(Descent, ReachesTheOnlySolutionsOfAThreeJointArm) {
  const auto chain = PlanarArm{.lengths_m = {0.5, 0.4, 0.2}}.chain();
  const Descent descent(chain);
  const Eigen::Isometry3d T = planar_pose(0.6, 0.3, 0.7);
  JointVector q = Eigen::Vector3d(0.4, 0.9, -0.3);
  EXPECT_LT(descent.run(T, Descent::Limits::Ignore, 30, q), 1e-18);
  EXPECT_TRUE(kinematics::T_base_tip(chain, q).isApprox(T, 1e-8));
}

TEST(Descent, AxesOtherThanZAreTurnedIntoIt) {
  kinematics::ChainParts parts;
  parts.base_link = "base";
  parts.tip_link = "tip";
  for (int j = 0; j < 6; ++j) {
    kinematics::Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.axis = Eigen::Vector3d(j % 3 == 0 ? -1 : 0.2, j % 3 == 1 ? 1 : 0.1, j % 3 == 2 ? 1 : -0.3)
                     .normalized();
    joint.T_previous_joint.translation() << 0.1 * j, 0.05, 0.3;
    joint.lower = -3;
    joint.upper = 3;
    parts.joints.push_back(joint);
  }
  parts.T_tip_transfer.translation() << 0, 0.1, 0.2;
  const kinematics::Chain chain(parts);
  JointVector q(6);
  q << 0.3, -0.4, 0.5, 0.6, -0.7, 0.8;
  const Eigen::Isometry3d T = kinematics::T_base_transfer(chain, q);
  q.array() += 0.1;
  EXPECT_LT(Descent(chain).run(T, Descent::Limits::Ignore, 30, q), 1e-18);
  EXPECT_TRUE(kinematics::T_base_transfer(chain, q).isApprox(T, 1e-8));
}

TEST(Descent, SteeringUsesRedundancyToReturnBetweenTheLimits) {
  const auto chain = PlanarArm{.lengths_m = {0.4, 0.3, 0.3, 0.2}, .limit = 1.5}.chain();
  const Descent descent(chain);
  const Eigen::Isometry3d T = planar_pose(0.7, 0.5, 0.9);
  const JointVector outside = Eigen::Vector4d(-0.9, 2.4, 0.3, -1.3);
  JointVector q = outside;
  EXPECT_LT(descent.run(T, Descent::Limits::Ignore, 40, q), 1e-18);
  EXPECT_FALSE(chain.within_limits(q));
  q = outside;
  EXPECT_LT(descent.run(T, Descent::Limits::Steer, 40, q), 1e-18);
  EXPECT_TRUE(chain.within_limits(q));
}

TEST(CounterGenerator, NegativeZeroIsZero) {
  const Eigen::Isometry3d plus(Eigen::Translation3d(0.0, 1, 1));
  const Eigen::Isometry3d minus(Eigen::Translation3d(-0.0, 1, 1));
  EXPECT_EQ(CounterGenerator(1, plus).next(), CounterGenerator(1, minus).next());
}

TEST(CounterGenerator, NeighbouringSeedsAndPosesDiffer) {
  std::set<std::uint64_t> firsts;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    for (int step = 0; step < 10; ++step) {
      const Eigen::Isometry3d pose(Eigen::Translation3d(1e-15 * step, 0, 0));
      firsts.insert(CounterGenerator(seed, pose).next());
    }
  EXPECT_EQ(firsts.size(), 1000U);
}

TEST(CounterGenerator, UniformFillsTheUnitInterval) {
  CounterGenerator generator(3);
  double sum = 0;
  double squares = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double u = generator.uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 0.005);
  EXPECT_NEAR(squares / kCount, 1.0 / 3, 0.005);
}

}  // namespace
}  // namespace kinship::inverse::joint_space_test
