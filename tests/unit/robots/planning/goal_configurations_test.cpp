#include "robots/planning/goal_configurations.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "tests/support/planar_arm.hpp"

namespace kinship::planning::goal_configurations_test {
namespace {

using test::planar_pose;
using test::PlanarArm;

/// Two links whose tip's place matters: two branches per pose, elbow to either side.
PlanarArm arm(double limit = M_PI) {
  PlanarArm arm;
  arm.lengths_m = {0.5, 0.4};
  arm.limit = limit;
  arm.yaw = false;
  arm.T_tip_transfer.translation().x() = 0.1;
  return arm;
}

const Eigen::Isometry3d kGoal = planar_pose(0.4, 0.5, 0);
const IsFree kEverythingFree = [](const Eigen::VectorXd&) { return true; };

Eigen::Matrix2Xd bounds_around_zero(const kinematics::Chain& chain) {
  return planning_bounds(chain, Eigen::VectorXd::Zero(chain.dof()));
}

TEST(GoalConfigurations, PutTheTransferFrameAtThePoseOnEveryBranch) {
  const auto chain = arm().chain();
  const auto goals = goal_configurations(chain, kGoal, bounds_around_zero(chain), kEverythingFree);
  ASSERT_EQ(goals.configurations.cols(), 2);
  EXPECT_LT(goals.configurations(1, 0) * goals.configurations(1, 1), 0);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Eigen::Isometry3d T = kinematics::T_base_transfer(chain, goals.configurations.col(i));
    EXPECT_LT((T.translation() - kGoal.translation()).norm(), 1e-6);
  }
  EXPECT_EQ(goals.reason, NoPath::None);
}

TEST(GoalConfigurations, KeepTheFreeOnesAndCountApart) {
  const auto chain = arm().chain();
  int asked = 0;
  const IsFree elbow_up = [&](const Eigen::VectorXd& q) {
    ++asked;
    return q[1] > 0;
  };
  const auto goals = goal_configurations(chain, kGoal, bounds_around_zero(chain), elbow_up);
  ASSERT_EQ(goals.configurations.cols(), 1);
  EXPECT_GT(goals.configurations(1, 0), 0);
  EXPECT_EQ(goals.found, 2);
  EXPECT_EQ(goals.within_bounds, 2);
  EXPECT_EQ(goals.collision_checks, 2u);
  EXPECT_EQ(asked, 2);
}

TEST(GoalConfigurations, AreTurnedToTheStart) {
  const auto chain = arm(2 * M_PI).chain();
  const Eigen::Matrix2Xd bounds = planning_bounds(chain, Eigen::Vector2d(4, 4));
  const auto goals = goal_configurations(chain, kGoal, bounds, kEverythingFree);
  ASSERT_GT(goals.configurations.cols(), 0);
  for (Eigen::Index i = 0; i < goals.configurations.cols(); ++i) {
    const Eigen::VectorXd q = goals.configurations.col(i);
    EXPECT_TRUE((q.transpose().array() >= bounds.row(0).array()).all());
    EXPECT_TRUE((q.transpose().array() <= bounds.row(1).array()).all());
    const Eigen::Isometry3d T = kinematics::T_base_transfer(chain, q);
    EXPECT_LT((T.translation() - kGoal.translation()).norm(), 1e-6);
  }
}

TEST(GoalConfigurations, ARedundantArmIsAskedAgainUntilOneIsFree) {
  PlanarArm redundant = arm();
  redundant.lengths_m = {0.3, 0.3, 0.2, 0.1};
  const auto chain = redundant.chain();
  const Eigen::Matrix2Xd bounds = bounds_around_zero(chain);
  int asked = 0;
  const IsFree from_the_seventh = [&](const Eigen::VectorXd&) { return ++asked > 6; };
  const auto goals =
      goal_configurations(chain, kGoal, bounds, from_the_seventh, {.max_configurations = 4});
  EXPECT_EQ(goals.configurations.cols(), 2);  // of the second four
  EXPECT_EQ(goals.found, 8);
  EXPECT_EQ(goals.collision_checks, 8U);
  EXPECT_EQ(goals.reason, NoPath::None);

  asked = -1'000'000;
  const auto none =
      goal_configurations(chain, kGoal, bounds, from_the_seventh, {.max_configurations = 4});
  EXPECT_EQ(none.configurations.cols(), 0);
  EXPECT_EQ(none.found, 40);
  EXPECT_EQ(none.reason, NoPath::GoalsCollide);
}

TEST(GoalConfigurations, SayWhyThereAreNone) {
  const auto chain = arm().chain();
  const Eigen::Matrix2Xd bounds = bounds_around_zero(chain);
  const auto far = goal_configurations(chain, planar_pose(3, 0, 0), bounds, kEverythingFree);
  EXPECT_EQ(far.configurations.cols(), 0);
  EXPECT_EQ(far.reason, NoPath::GoalOutOfReach);
  const auto blocked =
      goal_configurations(chain, kGoal, bounds, [](const Eigen::VectorXd&) { return false; });
  EXPECT_EQ(blocked.reason, NoPath::GoalsCollide);
  EXPECT_EQ(blocked.configurations.rows(), 2);
  const Eigen::Matrix2Xd tight = Eigen::Matrix2Xd::Constant(2, 2, 3.0);
  EXPECT_EQ(goal_configurations(chain, kGoal, tight, kEverythingFree).reason,
            NoPath::GoalOutsideBounds);
}

}  // namespace
}  // namespace kinship::planning::goal_configurations_test
