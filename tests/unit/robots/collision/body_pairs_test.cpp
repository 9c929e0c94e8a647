#include "robots/collision/body.hpp"

#include <gtest/gtest.h>

#include "robots/collision/lane_world.hpp"
#include "tests/unit/robots/collision/toy_arm.hpp"

namespace kinship::collision::body_pairs_test {
namespace {

using Pairs = std::vector<std::pair<int, int>>;
using test_support::toy_chain;

TEST(NeighbouringLinks, AreJoinedByOneMovingJoint) {
  EXPECT_EQ(neighbouring_links(toy_chain(3), {true, true, true, true}),
            (Pairs{{0, 1}, {1, 2}, {2, 3}}));
}

TEST(NeighbouringLinks, AreNotThoseWithTwoMovingJointsBetweenThem) {
  EXPECT_EQ(neighbouring_links(toy_chain(3), {true, true, false, true}), (Pairs{{0, 1}}));
}

/// base - arm - flange (fixed, shapeless) - hand (fixed) and a frame without shape below the base.
kinematics::Chain chain_with_fixed_links() {
  kinematics::ChainParts parts;
  parts.base_link = "base";
  parts.tip_link = "hand";
  kinematics::Joint joint;
  joint.lower = -1;
  joint.upper = 1;
  parts.joints = {joint, joint};
  const auto here = Eigen::Isometry3d::Identity();
  parts.links = {{"world", -1, here, -1}, {"base", -1, here, 0},  {"mount", 0, here, 1},
                 {"arm", 0, here, 2},     {"flange", 1, here, 3}, {"hand", 1, here, 4},
                 {"pillar", -1, here, 0}};
  return kinematics::Chain(parts);
}

TEST(NeighbouringLinks, LookThroughLinksWithoutShape) {
  EXPECT_EQ(
      neighbouring_links(chain_with_fixed_links(), {false, true, false, true, false, true, false}),
      (Pairs{{1, 3}, {3, 5}}));
}

TEST(NeighbouringLinks, StopAtLinksWithShape) {
  // The hand hangs on the flange, which has a shape now: hand and arm are no neighbours.
  EXPECT_EQ(
      neighbouring_links(chain_with_fixed_links(), {false, true, false, true, true, true, true}),
      (Pairs{{1, 3}, {3, 4}}));
}

TEST(NeighbouringLinks, MeetThroughAShapelessRoot) {
  EXPECT_EQ(
      neighbouring_links(chain_with_fixed_links(), {false, false, false, true, false, false, true}),
      (Pairs{{3, 6}}));
}

Eigen::Matrix3d turned(double angle_rad, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle_rad, axis.normalized()).toRotationMatrix();
}

TEST(LaneLayout, QuarterTurnsMapAxesToAxes) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(is_of_quarter_turns(Eigen::Matrix3d::Identity()));
  EXPECT_TRUE(is_of_quarter_turns(turned(M_PI / 2, z) * turned(-M_PI, x)));
  EXPECT_FALSE(is_of_quarter_turns(turned(1e-6, z)));
  EXPECT_FALSE(is_of_quarter_turns(turned(M_PI / 4, x)));
}

TEST(LaneLayout, TheAxesOfMostBoxesAreTaken) {
  const Eigen::Matrix3d square = turned(0.4, {1, 2, 3}), odd = turned(1.1, {3, -1, 1});
  const Eigen::Matrix3d quarter = turned(M_PI / 2, Eigen::Vector3d::UnitY());
  const Eigen::Matrix3d found = common_axes({odd, square, square * quarter, square});
  EXPECT_TRUE(is_of_quarter_turns(found.transpose() * square));
  EXPECT_TRUE(common_axes({}).isIdentity());
}

}  // namespace
}  // namespace kinship::collision::body_pairs_test
