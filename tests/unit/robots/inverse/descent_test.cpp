#include "robots/inverse/descent.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/planar_arm.hpp"

namespace kinship::inverse::descent_test {
namespace {

using test::planar_axes;
using test::planar_pose;
using test::PlanarArm;
constexpr double kPi = std::numbers::pi;

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

}  // namespace
}  // namespace kinship::inverse::descent_test
