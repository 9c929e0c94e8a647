#include "robots/collision/body_pairs.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace kinship::collision::body_pairs_test
