#include "robots/planning/goal_configurations.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/planar_arm.hpp"

namespace kinship::planning::start_configuration_test {
namespace {

using test::planar_pose;
using test::PlanarArm;

/// Two links whose tip's place matters: two branches per pose, elbow to either side.
kinematics::Chain two_branches(double limit = std::numbers::pi) {
  PlanarArm arm;
  arm.lengths_m = {0.5, 0.4};
  arm.limit = limit;
  arm.yaw = false;
  return arm.chain();
}

const Eigen::Isometry3d kStart = planar_pose(0.4, 0.5, 0);
const IsFree kEverythingFree = [](const Eigen::VectorXd&) { return true; };

StartConfiguration start_of(const kinematics::Chain& chain, const Eigen::Isometry3d& T_base_start,
                            const Eigen::MatrixXd& goals = Eigen::MatrixXd(2, 0),
                            const IsFree& is_free = kEverythingFree) {
  return start_configuration(chain, inverse::Solver(chain), T_base_start, goals, is_free);
}

TEST(StartConfiguration, IsTheBranchNearestToAGoalConfiguration) {
  const auto chain = two_branches();
  for (const double elbow : {1.0, -1.0}) {
    Eigen::MatrixXd goals(2, 1);
    goals << 0, elbow;
    const StartConfiguration start = start_of(chain, kStart, goals);
    ASSERT_TRUE(start.q);
    EXPECT_GT((*start.q)[1] * elbow, 0);
    EXPECT_TRUE(kinematics::T_base_transfer(chain, *start.q)
                    .translation()
                    .isApprox(kStart.translation(), 1e-6));
    EXPECT_EQ(start.collision_checks, 2U);
    EXPECT_EQ(start.reason, NoPath::None);
  }
}

TEST(StartConfiguration, AnyOfTheGoalsCounts) {
  Eigen::MatrixXd goals(2, 2);
  goals << -3, 1.5, -3, -1.4;
  EXPECT_LT((*start_of(two_branches(), kStart, goals).q)[1], 0);
}

TEST(StartConfiguration, WithoutGoalsIsTheOneNearestToTheMiddleOfTheLimits) {
  // Both branches bend by as much; the one is chosen whose first joint turns less.
  const StartConfiguration left = start_of(two_branches(), planar_pose(0.3, 0.6, 0));
  const StartConfiguration right = start_of(two_branches(), planar_pose(0.3, -0.6, 0));
  ASSERT_TRUE(left.q && right.q);
  EXPECT_GT((*left.q)[1], 0);
  EXPECT_LT((*right.q)[1], 0);
}

TEST(StartConfiguration, IsFree) {
  Eigen::MatrixXd goals(2, 1);
  goals << 0, 1;
  const IsFree elbow_down = [](const Eigen::VectorXd& q) { return q[1] < 0; };
  EXPECT_LT((*start_of(two_branches(), kStart, goals, elbow_down).q)[1], 0);
}

TEST(StartConfiguration, SaysWhyThereIsNone) {
  const IsFree nothing_free = [](const Eigen::VectorXd&) { return false; };
  const StartConfiguration colliding =
      start_of(two_branches(), kStart, Eigen::MatrixXd(2, 0), nothing_free);
  EXPECT_FALSE(colliding.q);
  EXPECT_EQ(colliding.reason, NoPath::StartCollides);
  EXPECT_EQ(colliding.collision_checks, 2U);
  EXPECT_EQ(start_of(two_branches(), planar_pose(3, 0, 0)).reason, NoPath::StartOutOfReach);
  EXPECT_EQ(start_of(two_branches(0.3), kStart).reason, NoPath::StartBeyondLimits);
}

}  // namespace
}  // namespace kinship::planning::start_configuration_test
