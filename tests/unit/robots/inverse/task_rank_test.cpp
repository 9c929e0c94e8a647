#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "robots/inverse/solver.hpp"
#include "robots/inverse/task_rank.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/chain_parts.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/screw_arm.hpp"

namespace kinship::inverse::task_rank_test {
namespace {

using kinematics::Chain;
using kinematics::JointType;
using test::arms::kX, test::arms::kY, test::arms::kZ;

constexpr std::uint64_t kSeed = 30;

/// Two slides along x, the second one askew, and three hinges.
Chain telescopes(double skew) {
  return test::screw_arm({{{0, 0, 0.5}, kX, JointType::Prismatic, 0.2},
                          {{0.3, 0, 0.5}, kX + skew * kY, JointType::Prismatic, 0.2},
                          {{0.6, 0, 0.5}, kZ},
                          {{0.6, 0, 0.5}, kY},
                          {{0.7, 0.1, 0.5}, kX}},
                         {0.8, 0, 0.5});
}

TEST(TaskRank, CountsDirectionsNotJoints) {
  EXPECT_EQ(task_rank(telescopes(0)), 4);
  EXPECT_TRUE(is_redundant(telescopes(0)));
  EXPECT_EQ(task_rank(telescopes(0.1)), 5);
  EXPECT_FALSE(is_redundant(telescopes(0.1)));
}

/// 1.57 is no quarter of a turn.
TEST(TaskRank, WhatRoundingMakesIsNoDirection) {
  EXPECT_EQ(task_rank(telescopes(8e-4)), 4);
  EXPECT_EQ(task_rank(telescopes(3e-3)), 5);
}

TEST(TaskRank, DependsOnTheTaskAxesThatMatter) {
  kinematics::ChainParts parts = test::parts_of(telescopes(0.1));
  parts.task_axes = {{true, false, false, true, true, true}};
  const Chain along_x(parts);
  EXPECT_EQ(task_rank(along_x), 4);
  EXPECT_TRUE(is_redundant(along_x));
}

/// A unit of length does not make a direction.
TEST(TaskRank, IsTheSameOfASmallArmAndOfALargeOne) {
  for (const double size : {1e-3, 30.0}) {
    kinematics::ChainParts parts = test::parts_of(test::arms::general());
    for (kinematics::Joint& joint : parts.joints)
      joint.T_previous_joint.translation() *= size;
    parts.T_last_tip.translation() *= size;
    EXPECT_EQ(task_rank(Chain(parts)), 6) << size;
  }
}

/// Their answers are those of the number of joints.
TEST(TaskRank, RobotsOfTheModelsHaveFullRankAndNoJointTwice) {
  for (const std::string name :
       {"panda", "iiwa14", "iiwa7", "ur10e", "sawyer", "sara_like", "planar_5r_a", "planar_7r_c"}) {
    const Chain chain = test::model_chain(name);
    const auto axes = std::ranges::count(chain.task_axes().matters, true);
    EXPECT_EQ(task_rank(chain), axes) << name;
    EXPECT_EQ(is_redundant(chain), chain.dof() > axes) << name;
    EXPECT_FALSE(has_repeated_joints(chain)) << name;
  }
}

TEST(TaskRank, NeighboursThatDoTheSameAreFoundAmongMoreJointsThanAxes) {
  std::mt19937_64 generator(kSeed);
  kinematics::ChainParts parts =
      test::parts_of(test::random_chain({.joints = 8, .limit = 2}, generator));
  EXPECT_FALSE(has_repeated_joints(Chain(parts)));
  parts.joints[4].axis = parts.joints[3].axis;  // on the same line
  parts.joints[4].T_previous_joint = Eigen::Translation3d(0.1 * parts.joints[3].axis);
  EXPECT_TRUE(has_repeated_joints(Chain(parts)));
}

TEST(TaskRank, TheJacobianIsThatOfTheTransferFrame) {
  std::mt19937_64 generator(kSeed);
  const Chain chain = test::random_chain({.joints = 7, .sliding_share = 0.3}, generator);
  const Eigen::VectorXd q = test::random_configuration(chain, generator);
  const kinematics::Jacobian J = task_jacobian(chain, q);
  constexpr double kStep = 1e-6;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    Eigen::VectorXd on = q, back = q;
    on[j] += kStep;
    back[j] -= kStep;
    const Eigen::Isometry3d T_on = kinematics::T_base_transfer(chain, on);
    const Eigen::Isometry3d T_back = kinematics::T_base_transfer(chain, back);
    const Eigen::AngleAxisd turn(T_on.linear() * T_back.linear().transpose());
    EXPECT_TRUE(((T_on.translation() - T_back.translation()) / (2 * kStep))
                    .isApprox(J.col(j).head<3>(), 1e-6));
    EXPECT_LT((turn.angle() * turn.axis() / (2 * kStep) - J.col(j).tail<3>()).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace kinship::inverse::task_rank_test
