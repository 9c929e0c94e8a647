// What a link beside the chain touches where the joint that it follows takes it.

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

#include "robots/collision/collision_world.hpp"
#include "robots/collision/edge_prover.hpp"
#include "robots/collision/pair_sampling.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/support/parallelogram_arm.hpp"

namespace kinship::collision::mimic_joints_test {
namespace {

using Names = std::pair<std::string, std::string>;

struct Arm {
  kinematics::Chain chain;
  geometry::RobotShapes shapes;
};

Arm arm() {
  const RobotDescription description = test::parallelogram_description();
  const kinematics::Chain chain = kinematics::read_chain(description).value_or_throw();
  return {
      chain,
      geometry::read_shapes(kinematics::read_model(description).value_or_throw()).value_or_throw()};
}

const Eigen::Vector4d kUp(0, 0, 0, 0), kLow(0, 1.1, 0, 0);

/// A ball where the middle of a link's solid is at a configuration, and nothing else is.
Surroundings ball_at(const std::string& link, const Eigen::Vector3d& p_link,
                     const Eigen::Vector4d& q) {
  Surroundings around;
  around.scene.objects.push_back({"ball", SphereShape{0.01},
                                  Eigen::Isometry3d(Eigen::Translation3d(
                                      test::followers_of_parallelogram(q).at(link) * p_link))});
  around.checks_links = false;
  return around;
}

TEST(MimicJoints, TouchWhatLiesWhereTheyAreTaken) {
  const Arm robot = arm();
  for (const auto& [link, p_link] : {std::pair<std::string, Eigen::Vector3d>("rod", {0, 0, 0.4}),
                                     {"level", {-0.15, -0.15, 0}},
                                     {"weight", {-0.2, 0, 0}},
                                     {"piston", {-0.4, 0, 0}},
                                     {"shutter", {0, 0, 0.05}}})
    for (const auto& [there, elsewhere] : {std::pair(kUp, kLow), std::pair(kLow, kUp)}) {
      CollisionWorld world(robot.chain, robot.shapes, ball_at(link, p_link, there));
      EXPECT_TRUE(world.collides(there)) << link;
      EXPECT_FALSE(world.collides(elsewhere)) << link;
      EXPECT_EQ(world.find_contact(there), (Names{link, "ball"}));
      CollisionWorld touched(robot.chain, robot.shapes, ball_at(link, p_link, there));
      EdgeProver prover(touched);
      EXPECT_FALSE(prover.prove(elsewhere, 2 * there - elsewhere).is_free()) << link;
    }
}

/// Lanes have room for so many moving joints; FCL answers for robots with more.
TEST(MimicJoints, ThatAreTooManyForTheLanesAreFoundByFcl) {
  RobotDescription description = test::parallelogram_description();
  std::string more, before = "rod";
  for (int i = 0; i < 30; ++i) {
    const std::string link = "more" + std::to_string(i);
    more.append("<link name='").append(link).append("'/><joint name='").append(link);
    more.append("_joint' type='continuous'><parent link='").append(before);
    more.append("'/><child link='").append(link);
    more.append("'/><axis xyz='0 1 0'/><mimic joint='lift' multiplier='0'/></joint>");
    before = link;
  }
  description.urdf.insert(description.urdf.find("</robot>"), more);
  const kinematics::Chain chain = kinematics::read_chain(description).value_or_throw();
  ASSERT_GT(chain.moving_joints(), kLaneJoints);
  CollisionWorld world(
      chain,
      geometry::read_shapes(kinematics::read_model(description).value_or_throw()).value_or_throw(),
      ball_at("weight", {-0.2, 0, 0}, kLow));
  EXPECT_TRUE(world.collides(kLow));
  EXPECT_FALSE(world.collides(kUp));
}

TEST(MimicJoints, AreNeighboursOfTheLinkThatTheyHangOn) {
  const Arm robot = arm();
  const LinkPairs unchecked = RobotSolids(robot.chain, robot.shapes).parts().unchecked;
  const auto is_unchecked = [&](const std::string& a, const std::string& b) {
    const std::pair<int, int> links =
        std::minmax(robot.chain.find_link(a), robot.chain.find_link(b));
    return unchecked.contains(links);
  };
  EXPECT_TRUE(is_unchecked("turret", "rod"));
  EXPECT_TRUE(is_unchecked("lower", "weight"));
  EXPECT_TRUE(is_unchecked("weight", "piston"));
  EXPECT_TRUE(is_unchecked("base", "shutter"));
  EXPECT_TRUE(is_unchecked("rod", "level")) << "they meet wherever the arm goes";
  EXPECT_FALSE(is_unchecked("turret", "weight"));
  EXPECT_FALSE(is_unchecked("hand", "rod")) << "counted one after the other";
  for (const SampledPair& pair : sample_pairs(robot.chain, robot.shapes, {}))
    if (pair.link_a == robot.chain.find_link("turret") &&
        pair.link_b == robot.chain.find_link("weight"))
      EXPECT_GT(pair.touched, 0U);
}

}  // namespace
}  // namespace kinship::collision::mimic_joints_test
