#include "server/transfer/arm_shape.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/chain_parts.hpp"
#include "tests/support/planar_arm.hpp"

namespace kinship::transfer::arm_shape_test {
namespace {

using test::planar_pose;
using test::PlanarArm;

TEST(ArmShape, PointsLieAtTheirSharesOfTheArmsLength) {
  const auto arm = PlanarArm{.lengths_m = {0.5, 0.3, 0.2}}.chain();
  const ArmShape straight = arm_shape(arm, Eigen::Vector3d::Zero());
  EXPECT_LT((straight.row(0).transpose() - Eigen::Vector4d(0.2, 0.4, 0.6, 0.8)).norm(), 1e-12);
  EXPECT_EQ(straight.bottomRows<2>().norm(), 0);

  // A right angle after 0.5 m: the points beyond lie on the turned part.
  const ArmShape bent = arm_shape(arm, Eigen::Vector3d(0, std::numbers::pi / 2, 0));
  EXPECT_LT((bent.col(1) - Eigen::Vector3d(0.4, 0, 0)).norm(), 1e-12);
  EXPECT_LT((bent.col(3) - Eigen::Vector3d(0.5, 0.3, 0)).norm(), 1e-12);
}

TEST(ArmShape, DoesNotDependOnHowManyJointsMakeIt) {
  const auto few = PlanarArm{.lengths_m = {0.5, 0.5}}.chain();
  const auto many = PlanarArm{.lengths_m = {0.2, 0.3, 0.1, 0.4}}.chain();
  const double distance = shape_distance(arm_shape(few, Eigen::Vector2d(0.3, -0.8)),
                                         arm_shape(many, Eigen::Vector4d(0.3, 0, -0.8, 0)));
  EXPECT_LT(distance, 1e-12);
}

TEST(ArmShape, CountsTheWayToTheTransferFrame) {
  const auto arm =
      PlanarArm{.lengths_m = {0.5, 0.3}, .T_tip_transfer = planar_pose(0, 0.2, 0)}.chain();
  EXPECT_LT((arm_shape(arm, Eigen::Vector2d::Zero()).col(3) -
             (Eigen::Vector3d(0.5, 0, 0) + (0.8 * (0.5 + std::hypot(0.3, 0.2)) - 0.5) *
                                               Eigen::Vector3d(0.3, 0.2, 0).normalized()))
                .norm(),
            1e-12);
}

TEST(ArmShape, IsSeenFromAnotherFrame) {
  const auto arm = PlanarArm{.lengths_m = {0.5, 0.5}}.chain();
  const auto turned = moved(planar_pose(0, 0, 0.7), arm_shape(arm, Eigen::Vector2d(0.1, 0.4)));
  EXPECT_LT(shape_distance(turned, arm_shape(arm, Eigen::Vector2d(0.8, 0.4))), 1e-12);
}

TEST(ArmShape, DoesNotCountWhatFollowsTheArmBesideIt) {
  const auto arm = PlanarArm{.lengths_m = {0.5, 0.3}}.chain();
  kinematics::ChainParts parts = test::parts_of(arm);
  kinematics::MimicJoint rod{parts.joints[0], 0, 1, -1, 0.2};
  rod.joint.T_previous_joint = planar_pose(0.4, 0.3, 0.5);
  parts.mimics.push_back(rod);
  const Eigen::Vector2d q(0.3, -0.8);
  EXPECT_EQ(shape_distance(arm_shape(kinematics::Chain(parts), q), arm_shape(arm, q)), 0);
}

TEST(ArmShape, AnArmOfNoLengthIsAPoint) {
  const auto arm = PlanarArm{.lengths_m = {0.0, 0.0}}.chain();
  EXPECT_EQ(arm_shape(arm, Eigen::Vector2d(1, 2)).norm(), 0);
}

}  // namespace
}  // namespace kinship::transfer::arm_shape_test
