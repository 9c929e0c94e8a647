// Links beside the chain that move with it.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/link_tree.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/support/parallelogram_arm.hpp"
#include "tests/unit/robots/kinematics/random_chains.hpp"

namespace kinship::kinematics::mimic_joints_test {
namespace {

constexpr std::uint64_t kSeed = 11;
constexpr double kTolerance = 1e-12;

Chain arm() { return read_chain(test::parallelogram_description()).value_or_throw(); }

Eigen::Isometry3d pose_of(const Chain& chain, const std::string& link, const Eigen::VectorXd& q) {
  return link_poses(chain, q)[static_cast<std::size_t>(chain.find_link(link))];
}

/// The arm's description with one text in the place of another one.
RobotDescription changed(const std::string& before, const std::string& after) {
  RobotDescription description = test::parallelogram_description();
  const std::size_t at = description.urdf.find(before);
  EXPECT_NE(at, std::string::npos) << before;
  description.urdf.replace(at, before.size(), after);
  return description;
}

std::string message(const RobotDescription& description) {
  const auto chain = read_chain(description);
  return chain ? "fine" : chain.error().message;
}

TEST(MimicJoints, MoveWithTheJointOfTheChainThatTheyFollow) {
  const Chain chain = arm();
  ASSERT_EQ(chain.dof(), 4);
  ASSERT_EQ(chain.mimics().size(), 5U);
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd q = random_configuration(chain, generator);
    for (const auto& [link, expected] : test::followers_of_parallelogram(q))
      EXPECT_TRUE(pose_of(chain, link, q).isApprox(expected, kTolerance)) << link;
  }
}

TEST(MimicJoints, CloseTheLoopOfAParallelogram) {
  const Chain chain = arm();
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 50; ++i) {
    const Eigen::VectorXd q = random_configuration(chain, generator);
    const Eigen::Vector3d on_rod = pose_of(chain, "rod", q) * Eigen::Vector3d(0, 0, 0.8);
    const Eigen::Vector3d on_level = pose_of(chain, "level", q) * Eigen::Vector3d(-0.3, -0.15, 0);
    EXPECT_TRUE(on_rod.isApprox(on_level, kTolerance));
    EXPECT_TRUE(pose_of(chain, "level", q)
                    .linear()
                    .isApprox(pose_of(chain, "turret", q).linear(), kTolerance));
  }
}

TEST(MimicJoints, ComeAfterTheJointsOfTheChain) {
  const Chain chain = arm();
  const auto joint_of = [&](const std::string& link) {
    return chain.links()[static_cast<std::size_t>(chain.find_link(link))].joint;
  };
  EXPECT_EQ(chain.moving_joints(), 9);
  EXPECT_EQ(joint_of("piston"), joint_of("cap"));
  EXPECT_EQ(chain.joint_before(joint_of("piston")), joint_of("weight"));
  EXPECT_EQ(chain.joint_before(joint_of("weight")), joint_of("lower"));
  EXPECT_EQ(chain.joint_before(joint_of("shutter")), -1);
  EXPECT_EQ(chain.joint_before(joint_of("lower")), joint_of("turret"));
  EXPECT_EQ(chain.last_source(joint_of("piston")), 2) << "the bend";
  EXPECT_EQ(chain.last_source(joint_of("rod")), 1) << "the lift, later than the swing";
  EXPECT_EQ(chain.last_source(joint_of("hand")), 3);
  EXPECT_EQ(chain.last_source(-1), -1);
  const MimicJoint& piston =
      chain.mimics()[static_cast<std::size_t>(joint_of("piston") - chain.dof())];
  EXPECT_NEAR(piston.joint.lower, -0.2 * (0.5 * 1.5 + 0.3) + 0.05, kTolerance);
  EXPECT_NEAR(piston.joint.upper, -0.2 * (0.5 * -1 + 0.3) + 0.05, kTolerance);
  const Eigen::VectorXd q = Eigen::Vector4d(0.1, 0.2, 0.3, 0.4);
  EXPECT_EQ(joint_poses(chain, q).size(), 9U);
  EXPECT_TRUE(T_base_transfer(chain, joint_poses(chain, q)).isApprox(T_base_transfer(chain, q)));
}

TEST(MimicJoints, DoNotCountForTheIdentity) {
  const Chain chain =
      read_chain(changed("multiplier=\"0.5\"", "multiplier=\"0.4\"")).value_or_throw();
  EXPECT_EQ(chain.digest(), arm().digest());
}

TEST(MimicJoints, StandWhereTheyAreHeldAndWhatFollowsThemToo) {
  RobotDescription description = test::parallelogram_description();
  description.held_joints = {{"weight_joint", 0.05}};
  const RobotModel robot = read_model(description).value_or_throw();
  const Chain& chain = robot.chain;
  EXPECT_EQ(chain.mimics().size(), 3U);
  const Eigen::Vector4d straight(0, 0, 0, 0), bent(0, 0, 1, 0);
  EXPECT_TRUE(pose_of(chain, "piston", bent).isApprox(pose_of(chain, "piston", straight)));
  EXPECT_NEAR(
      (pose_of(chain, "weight", bent).inverse() * pose_of(chain, "piston", bent)).translation().x(),
      -0.2 * 0.05 + 0.05, kTolerance);
  const auto held = held_values(robot);
  EXPECT_EQ(held.size(), 2U);
  EXPECT_NEAR(held.at("piston_joint"), 0.04, kTolerance);
  EXPECT_TRUE(held_values(read_model(test::parallelogram_description()).value_or_throw()).empty());
}

TEST(MimicJoints, ThatFollowEachOtherInALoopAreRefusedByName) {
  EXPECT_EQ(message(changed("mimic joint=\"bend\"", "mimic joint=\"piston_joint\"")),
            "joint 'weight_joint', which mimics 'piston_joint', which mimics 'weight_joint': a "
            "loop of mimic joints");
  EXPECT_EQ(message(changed("mimic joint=\"bend\"", "mimic joint=\"weight_joint\"")),
            "joint 'weight_joint', which mimics 'weight_joint': a loop of mimic joints");
  RobotDescription broken = changed("mimic joint=\"bend\"", "mimic joint=\"piston_joint\"");
  broken.held_joints = {{"piston_joint", 0}};
  EXPECT_EQ(message(broken), "fine");
}

TEST(MimicJoints, OfAJointThatIsNotThereAreRefusedUnlessHeld) {
  RobotDescription broken = changed("mimic joint=\"bend\"", "mimic joint=\"bent\"");
  EXPECT_EQ(message(broken),
            "joint 'weight_joint' mimics joint 'bent', which is not in the URDF; hold it where it "
            "stands");
  const auto tree = read_link_tree(broken.urdf).value_or_throw();
  const auto weight = std::ranges::find(tree, "weight", &TreeLink::name);
  EXPECT_EQ(weight->joint.fault, "mimics joint 'bent', which is not in the URDF");
  broken.held_joints = {{"weight_joint", 0}};
  EXPECT_EQ(message(broken), "fine");
}

TEST(MimicJoints, ThatCannotBeFollowedAreRefusedByName) {
  EXPECT_EQ(message(changed("multiplier=\"0.5\"", "multiplier=\"1e200\"")),
            "joint 'weight_joint' mimics joint 'bend' at -1e+200, more than 1000");
  EXPECT_EQ(message(changed("<mimic joint=\"lift\"/>", "<mimic joint=\"swing\"/>")), "fine");
  EXPECT_EQ(
      message(changed("<mimic joint=\"lift\"/>", "<mimic joint=\"swing\" multiplier=\"0.5\"/>")),
      "joint 'rod_joint' mimics joint 'swing', which is continuous, times 0.5: where it "
      "stands would depend on full turns, which is not supported; hold it");
  EXPECT_NE(message(changed("<mimic joint=\"lift\" multiplier=\"0.6\"",
                            "<mimic joint=\"swing\" multiplier=\"1\""))
                .find("'shutter_joint' mimics joint 'swing', which is continuous"),
            std::string::npos)
      << "it slides on with each turn";
  EXPECT_EQ(message(changed("<axis xyz=\"0 2 0\"/>", "<axis xyz=\"0 0 0\"/>")),
            "joint 'weight_joint': axis has length 0, which gives no direction");
}

TEST(MimicJoints, BeforeTheBaseLinkAreRefusedByName) {
  RobotDescription description = test::parallelogram_description();
  description.base_link = "weight";
  description.tip_link = "piston";
  EXPECT_EQ(
      message(description),
      "joint 'piston_joint' on the chain mimics joint 'weight_joint', which is not supported");
  description = changed("mimic joint=\"bend\"", "mimic joint=\"last\"");
  const std::size_t end = description.urdf.find("</robot>");
  description.urdf.insert(
      end,
      "<link name='end'/><joint name='last' type='revolute'><parent link='cap'/><child "
      "link='end'/><axis xyz='1 0 0'/><limit lower='0' upper='1' effort='1' "
      "velocity='1'/></joint>");
  description.base_link = "cap";
  description.tip_link = "end";
  EXPECT_EQ(message(description),
            "joint 'piston_joint' before the base link follows joint 'last' of the chain, which is "
            "not supported; hold it");
}

TEST(Chain, RefusesMimicJointsThatAreNoneAndNamesThem) {
  std::mt19937_64 generator(kSeed);
  const ChainParts parts = random_parts(3, generator);
  const auto fault_after = [&](int before, int source, double axis) {
    ChainParts broken = parts;
    MimicJoint mimic{parts.joints[0], before, source, 0.5, 0};
    mimic.joint.name = "rod";
    mimic.joint.axis *= axis;
    broken.mimics.push_back(mimic);
    return validate(broken).value_or("none");
  };
  EXPECT_EQ(fault_after(2, 0, 1), "none");
  EXPECT_EQ(fault_after(3, 0, 1), "joint 'rod': joint index 3 is not below its own, 3");
  EXPECT_EQ(fault_after(-2, 0, 1), "joint 'rod': joint index -2 is not below its own, 3");
  EXPECT_EQ(fault_after(-1, 3, 1), "joint 'rod': mimics joint 3 of 3");
  EXPECT_EQ(fault_after(-1, -1, 1), "joint 'rod': mimics joint -1 of 3");
  EXPECT_NE(fault_after(-1, 0, 2).find("joint 'rod': axis has length"), std::string::npos);
}

}  // namespace
}  // namespace kinship::kinematics::mimic_joints_test
