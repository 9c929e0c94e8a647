#include <gtest/gtest.h>

#include <string>

#include "robots/inverse/solver.hpp"
#include "robots/inverse/unreached.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/support/chain_parts.hpp"
#include "tests/support/parallelogram_arm.hpp"
#include "tests/support/screw_arm.hpp"
#include "tests/unit/robots/inverse/checked_inverse.hpp"

namespace kinship::inverse::unreached_test {
namespace {

using kinematics::Chain;
using kinematics::JointType;
using test::arms::kX, test::arms::kY, test::arms::kZ;

/// A base that turns, three hinges in a plane, a hand that turns about the forearm.
Chain five_joints() {
  return test::screw_arm({{{0, 0, 0.1}, kZ, JointType::Revolute, 3},
                          {{0, 0, 0.15}, kY, JointType::Revolute, 1.8},
                          {{0, 0, 0.45}, kY, JointType::Revolute, 2.5},
                          {{0, 0, 0.7}, kY, JointType::Revolute, 1.9},
                          {{0, 0, 0.78}, kZ, JointType::Revolute, 3.1}},
                         {0, 0, 0.78});
}

const Eigen::VectorXd kBent = (Eigen::VectorXd(5) << 0.4, 0.3, 1, 0.5, -0.7).finished();

TEST(Unreached, AnOrientationThatIsOffByRoundingIsToldFromThePlaceAndAxesAreNamed) {
  const Chain chain = five_joints();
  // Out of the plane that the hinges turn in: no joint does that.
  const Eigen::Vector3d in_plane(std::cos(kBent[0]), std::sin(kBent[0]), 0);
  Eigen::Isometry3d T = kinematics::T_base_tip(chain, kBent);
  T.linear() = Eigen::AngleAxisd(1e-3, in_plane) * T.linear();
  ASSERT_EQ(Solver(chain).solve(T).configurations.cols(), 0);
  const Unreached unreached = find_unreached(chain, T);
  EXPECT_TRUE(unreached.beyond.empty());
  EXPECT_FALSE(unreached.distance_m);
  ASSERT_TRUE(unreached.angle_rad);
  EXPECT_GT(*unreached.angle_rad, 1e-5);
  EXPECT_LE(*unreached.angle_rad, 1.001e-3);
  ASSERT_TRUE(unreached.axes);
  kinematics::ChainParts parts = test::parts_of(chain);
  parts.task_axes = *unreached.axes;
  EXPECT_EQ(std::ranges::count(unreached.axes->matters, true), 5);
  EXPECT_GT(Solver(Chain(parts)).solve(T).configurations.cols(), 0);
  const std::string said = describe(unreached, chain);
  EXPECT_EQ(said.find("its place is in reach, its orientation is not, by 0.0"), 0U) << said;
  EXPECT_NE(said.find("; with --axes x,y,z,"), std::string::npos) << said;
}

/// With the place held, what is left is the angle between the axis of the hand and the plane.
TEST(Unreached, TheAngleIsTheLeastThatThePlaceAllows) {
  const Chain chain = five_joints();
  const Eigen::Vector3d in_plane(std::cos(kBent[0]), std::sin(kBent[0]), 0);
  const Eigen::Isometry3d T_bent = kinematics::T_base_tip(chain, kBent);
  const Eigen::Vector3d hand = T_bent.linear().col(2);
  const Eigen::Vector3d out_of_plane = in_plane.cross(kZ);
  Eigen::Isometry3d T = T_bent;
  T.linear() = Eigen::AngleAxisd(0.2, hand.cross(out_of_plane).normalized()) * T.linear();
  const Unreached unreached = find_unreached(chain, T);
  ASSERT_TRUE(unreached.angle_rad);
  EXPECT_NEAR(*unreached.angle_rad, 0.2, 1e-6);
}

TEST(Unreached, TheJointIsNamedWhoseLimitIsInTheWay) {
  const Chain arm = test::arms::industrial();
  Eigen::VectorXd q(6);
  q << 0.3, -0.4, 0.6, 0.2, 0.8, -0.5;
  const Eigen::Isometry3d T = kinematics::T_base_tip(arm, q);
  Eigen::VectorXd lower = q.array() - 0.3, upper = q.array() + 0.3;
  upper[2] = 0.5;
  const Chain narrow = with_limits(arm, lower, upper);
  const Unreached unreached = find_unreached(narrow, T);
  ASSERT_EQ(unreached.beyond.size(), 1U);
  EXPECT_EQ(unreached.beyond[0].joint, 2U);
  EXPECT_NEAR(unreached.beyond[0].value, 0.6, 1e-6);
  EXPECT_EQ(unreached.beyond[0].limit, 0.5);
  const std::string said = describe(unreached, narrow);
  EXPECT_EQ(said.find("joint 'joint3' would have to go to 0.6 rad (0.1 rad beyond its limit)"), 0U)
      << said;
}

TEST(Unreached, ASlideThatIsTooShortIsNamedInMetres) {
  const Chain lift = test::screw_arm({{{0, 0, 0.4}, kZ, JointType::Prismatic, 0.3},
                                      {{0, 0, 0.4}, kZ, JointType::Revolute, 2},
                                      {{0.5, 0, 0.4}, kZ, JointType::Revolute, 2}},
                                     {0.9, 0, 0.4});
  const Eigen::Isometry3d T = kinematics::T_base_tip(lift, Eigen::Vector3d(0.25, 0.5, 1));
  const Unreached unreached = find_unreached(lift, Eigen::Translation3d(0, 0, 0.5) * T);
  ASSERT_EQ(unreached.beyond.size(), 1U);
  EXPECT_NEAR(unreached.beyond[0].value, 0.75, 1e-6);
  ASSERT_TRUE(unreached.distance_m);
  EXPECT_NEAR(*unreached.distance_m, 0.45, 1e-3);
  EXPECT_EQ(describe(unreached, lift),
            "joint 'joint1' would have to go to 0.75 m (0.45 m beyond its limit); its place is out "
            "of reach by 0.45 m");
}

TEST(Unreached, AxesThatTheJointsDoNotServeAreLeftOut) {
  const Chain planar =
      test::screw_arm({{{0, 0, 0.4}, kZ}, {{0.5, 0, 0.4}, kZ}, {{0.9, 0, 0.4}, kZ}}, {1.1, 0, 0.4});
  const Eigen::Isometry3d T = kinematics::T_base_tip(planar, Eigen::Vector3d(0.3, 0.5, 1));
  const Unreached unreached = find_unreached(planar, Eigen::Translation3d(0, 0, 1e-4) * T);
  EXPECT_EQ(describe(unreached, planar),
            "its place is out of reach by 0.0001 m; with --axes x,y,roll,pitch,yaw it is reached");
}

TEST(Unreached, OfAPlaceThatIsTooFarThereIsNothingToName) {
  const Chain chain = test::arms::industrial();
  const Unreached unreached =
      find_unreached(chain, Eigen::Isometry3d(Eigen::Translation3d(9, 0, 0)));
  EXPECT_TRUE(unreached.beyond.empty());
  EXPECT_FALSE(unreached.axes);
  ASSERT_TRUE(unreached.distance_m);
  // Straight out from joint 2, but for the offset of the hand that the place asks nothing of.
  EXPECT_GT(*unreached.distance_m, 5.5);
  EXPECT_LT(*unreached.distance_m, 6.2);
}

TEST(Unreached, MimicJointsBesideTheChainChangeNothing) {
  const Chain chain = kinematics::read_chain(test::parallelogram_description()).value_or_throw();
  ASSERT_FALSE(chain.mimics().empty());
  const Unreached unreached =
      find_unreached(chain, Eigen::Isometry3d(Eigen::Translation3d(9, 0, 0)));
  ASSERT_TRUE(unreached.distance_m);
  EXPECT_GT(*unreached.distance_m, 5);
}

}  // namespace
}  // namespace kinship::inverse::unreached_test
