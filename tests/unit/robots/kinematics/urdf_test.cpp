#include "robots/kinematics/urdf.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "proto/types/limits.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/unit/robots/kinematics/small_arm.hpp"

namespace kinship::kinematics::urdf_test {
namespace {

constexpr double kTolerance = 1e-12;

std::string message(const RobotDescription& description) {
  const auto chain = read_chain(description);
  return chain ? "fine" : chain.error().message;
}

std::string origin(const std::string& xyz, const std::string& rpy = "0 0 0") {
  return "<origin xyz='" + xyz + "' rpy='" + rpy + "'/>";
}

/// world -lift- rail -x- base -j1- mid -j2- hand -fixed- tip, a finger on the hand, a lamp on rail.
RobotDescription large_robot() {
  return described(robot_text(
      "world rail base mid hand tip finger lamp",
      joint_text("lift", "prismatic", "world", "rail",
                 "<axis xyz='0 0 2'/><limit lower='0.5' upper='1' effort='1' velocity='1'/>") +
          joint_text("x", "fixed", "rail", "base", origin("1 0 0", "0 0 1.5707963267948966")) +
          joint_text("j1", "continuous", "base", "mid", kAlongZ + origin("0 0 0.25")) +
          joint_text("j2", "prismatic", "mid", "hand", kLimit + "<axis xyz='3 0 0'/>") +
          joint_text("mount", "fixed", "hand", "tip", origin("0 0 0.5")) +
          joint_text("grip", "prismatic", "hand", "finger",
                     kLimit + kAlongZ + "<mimic joint='lift'/>" + origin("0 1 0")) +
          joint_text("arm", "fixed", "rail", "lamp", origin("0 0 3"))));
}

Eigen::Vector3d position_of(const Chain& chain, const std::string& link, const Eigen::Vector2d& q) {
  return link_poses(chain, q)[static_cast<std::size_t>(chain.find_link(link))].translation();
}

TEST(ReadChain, FollowsTheJointsFromBaseToTip) {
  const Chain chain = read_chain(large_robot()).value_or_throw();
  ASSERT_EQ(chain.dof(), 2);
  EXPECT_EQ(chain.joints()[0].type, JointType::Continuous);
  EXPECT_EQ(chain.upper()[0], std::numbers::pi);
  EXPECT_EQ(chain.joints()[1].name, "j2");
  EXPECT_TRUE(chain.joints()[1].axis.isApprox(Eigen::Vector3d::UnitX()));
  const Eigen::Isometry3d T = T_base_tip(chain, Eigen::Vector2d(std::numbers::pi / 2, 2));
  EXPECT_TRUE(T.translation().isApprox(Eigen::Vector3d(0, 2, 0.75), kTolerance));
}

TEST(ReadChain, KeepsEveryLinkAfterItsParent) {
  const Chain chain = read_chain(large_robot()).value_or_throw();
  ASSERT_EQ(chain.links().size(), 8U);
  const auto parent = [&](const std::string& link) {
    const int index = chain.links()[static_cast<std::size_t>(chain.find_link(link))].parent;
    return index < 0 ? "" : chain.links()[static_cast<std::size_t>(index)].name;
  };
  EXPECT_EQ(parent("world"), "");
  EXPECT_EQ(parent("base"), "rail");
  EXPECT_EQ(parent("finger"), "hand");
}

TEST(ReadChain, HoldsJointsOffTheChainAtZeroOrTheNearestLimit) {
  const Chain chain = read_chain(large_robot()).value_or_throw();
  const Eigen::Vector2d q(0, 1);
  EXPECT_TRUE(position_of(chain, "base", q).isZero());
  EXPECT_TRUE(position_of(chain, "world", q).isApprox(Eigen::Vector3d(0, 1, -0.5), kTolerance));
  EXPECT_TRUE(position_of(chain, "lamp", q).isApprox(Eigen::Vector3d(0, 1, 3), kTolerance));
}

TEST(ReadChain, AMimicJointOffTheChainStandsWhereItsJointPutsIt) {
  RobotDescription description = large_robot();
  const Eigen::Vector2d q(0, 1);
  const auto finger_z = [&] {
    return position_of(read_chain(description).value_or_throw(), "finger", q).z() - 0.25;
  };
  EXPECT_NEAR(finger_z(), 0.5, kTolerance) << "the lift stands at its lower limit";
  description.held_joints = {{"lift", 0.75}};
  EXPECT_NEAR(finger_z(), 0.75, kTolerance);
  const auto mimicking = [&](const std::string& mimic) {
    const std::size_t at = description.urdf.find("<mimic");
    description.urdf.replace(at, description.urdf.find('>', at) + 1 - at, mimic);
  };
  mimicking("<mimic joint='lift' multiplier='-1' offset='0.5'/>");
  EXPECT_NEAR(finger_z(), -0.25, kTolerance);
  mimicking("<mimic joint='lift' multiplier='9'/>");
  EXPECT_NEAR(finger_z(), 2, kTolerance) << "its own upper limit";
  mimicking("<mimic joint='j2' offset='0.5'/>");
  EXPECT_NEAR(finger_z(), 1.5, kTolerance) << "a joint of the chain is followed";
  mimicking("<mimic joint='lift' multiplier='1e200'/>");
  EXPECT_NE(message(description).find("mimics joint 'lift'"), std::string::npos)
      << message(description);
}

TEST(ReadModel, TakesAParsedUrdfForAnotherDescriptionOfTheSameText) {
  const RobotDescription description = two_joints("fixed", "");
  const RobotModel robot = read_model(description).value_or_throw();
  EXPECT_EQ(name_in_urdf(robot), "small");
  RobotDescription other = description;
  other.T_tip_transfer.translation().x() = 0.1;
  const RobotModel again = read_model(other, robot.urdf).value_or_throw();
  EXPECT_EQ(again.urdf.tree, robot.urdf.tree);
  EXPECT_EQ(again.chain.digest(), read_chain(other).value_or_throw().digest());
  EXPECT_NE(again.chain.digest(), robot.chain.digest());
  other.tip_link = "nose";
  EXPECT_FALSE(read_model(other, robot.urdf));
}

TEST(ReadChain, HoldsJointsWhereToldAndNowhereElse) {
  RobotDescription description = large_robot();
  description.held_joints = {{"lift", 0.75}, {"grip", 0.125}};
  const Chain chain = read_chain(description).value_or_throw();
  const Eigen::Vector2d q(0, 1);
  EXPECT_TRUE(position_of(chain, "world", q).isApprox(Eigen::Vector3d(0, 1, -0.75), kTolerance));
  EXPECT_TRUE(position_of(chain, "finger", q).isApprox(Eigen::Vector3d(1, 1, 0.375), kTolerance));
  const auto refused = [&](const std::string& joint, double value) {
    description.held_joints = {{joint, value}};
    return message(description);
  };
  EXPECT_EQ(refused("none", 0), "held joint 'none': not in the URDF");
  EXPECT_EQ(refused("j2", 0), "held joint 'j2': is on the chain");
  EXPECT_EQ(refused("mount", 0), "held joint 'mount': is on the chain");
  EXPECT_EQ(refused("arm", 0), "held joint 'arm': is fixed, floating or planar");
  EXPECT_EQ(refused("lift", 0.25), "held joint 'lift': value 0.25 is outside its limits 0.5 to 1");
  EXPECT_EQ(refused("grip", std::numeric_limits<double>::quiet_NaN()),
            "held joint 'grip': value nan is outside its limits -1 to 2");
  EXPECT_NE(refused(std::string(200, 'x'), 0).find("200 bytes"), std::string::npos);
}

TEST(ReadChain, TakesTheStricterOfHardAndSoftLimits) {
  const auto limits = [](const std::string& lower, const std::string& upper) {
    return two_joints("revolute", kAlongZ + kLimit + "<safety_controller k_velocity='1'" +
                                      " soft_lower_limit='" + lower + "' soft_upper_limit='" +
                                      upper + "'/>");
  };
  const Chain chain = read_chain(limits("-0.5", "3")).value_or_throw();
  EXPECT_EQ(chain.lower()[1], -0.5);
  EXPECT_EQ(chain.upper()[1], 2);
  EXPECT_EQ(read_chain(limits("-3", "1.5")).value_or_throw().upper()[1], 1.5);
  EXPECT_EQ(read_chain(limits("0", "0")).value_or_throw().lower()[1], -1);
  EXPECT_EQ(message(limits("1", "-1")),
            "joint 'j2': lower soft limit 1 exceeds upper soft limit -1");
  EXPECT_EQ(message(limits("3", "4")),
            "joint 'j2': lower (hard and soft) limit 3 exceeds upper (hard and soft) limit 2");
}

TEST(ReadChain, IgnoresTheLimitsOfContinuousJoints) {
  const Chain chain = read_chain(two_joints("continuous", kAlongZ + kLimit)).value_or_throw();
  EXPECT_EQ(chain.lower()[1], -std::numbers::pi);
}

TEST(ReadChain, RefusesJointsItCannotFollow) {
  EXPECT_NE(message(two_joints("revolute", kAlongZ)).find("j2"), std::string::npos);
  EXPECT_EQ(message(two_joints("revolute", kAlongZ + "<limit effort='1' velocity='1'/>")),
            "joint 'j2': lower limit 0 is not below upper limit 0");
  EXPECT_EQ(message(two_joints("revolute",
                               kAlongZ + "<limit lower='2' upper='1' effort='1' velocity='1'/>")),
            "joint 'j2': lower limit 2 exceeds upper limit 1");
  EXPECT_EQ(message(two_joints("revolute", kLimit + "<axis xyz='0 0 0'/>")),
            "joint 'j2': axis has length 0, which gives no direction");
  EXPECT_EQ(message(two_joints("revolute", kLimit + kAlongZ + "<mimic joint='j1'/>")),
            "joint 'j2' on the chain mimics joint 'j1', which is not supported");
  EXPECT_EQ(message(two_joints("floating", "")),
            "joint 'j2' on the chain is floating or planar, which is not supported");
  EXPECT_EQ(message(two_joints("planar", kAlongZ)),
            "joint 'j2' on the chain is floating or planar, which is not supported");
}

TEST(ReadChain, RefusesFarOrigins) {
  EXPECT_EQ(message(two_joints("revolute", kLimit + kAlongZ + origin("0 1001 0"))),
            "joint 'j2': coordinate 1001 m exceeds 1000 m");
  EXPECT_EQ(message(two_joints("fixed", origin("0 1e300 0"))),
            "tip link 'tip': coordinate 1e+300 m exceeds 1000 m");
}

TEST(ReadChain, RefusesLinksThatDoNotMakeAChain) {
  RobotDescription description = large_robot();
  description.base_link = "bottom";
  EXPECT_EQ(message(description),
            "base link 'bottom': not in the URDF (it has 'base', 'finger', 'hand', 'lamp', 'mid', "
            "'rail' and 2 more)");
  description.base_link = "bsae";
  EXPECT_EQ(message(description), "base link 'bsae': not in the URDF (did you mean 'base'?)");
  description.base_link = "lamp";
  EXPECT_EQ(message(description), "base link 'lamp' is not an ancestor of tip link 'tip'");
  description.base_link = "hand";
  EXPECT_EQ(message(description), "chain: no moving joint");
  description.base_link = "tip";
  EXPECT_EQ(message(description), "chain: no moving joint");
  description.tip_link = "";
  EXPECT_EQ(message(description), "tip link: name is empty");
  description.tip_link = std::string(129, 'x');
  EXPECT_EQ(message(description), "tip link: name of 129 bytes exceeds 128");
}

TEST(ReadChain, RefusesTooManyJoints) {
  std::string links = "base", joints;
  for (std::size_t i = 0; i <= kMaxDof; ++i) {
    const std::string child = i == kMaxDof ? "tip" : "l" + std::to_string(i);
    joints += joint_text("j" + std::to_string(i), "revolute",
                         i == 0 ? "base" : "l" + std::to_string(i - 1), child, kLimit + kAlongZ);
    links += " " + child;
  }
  EXPECT_EQ(message(described(robot_text(links, joints))), "chain: 33 moving joints exceed 32");
}

TEST(ReadChain, ChecksTheRestOfTheDescription) {
  RobotDescription description = large_robot();
  description.label = "";
  EXPECT_EQ(message(description), "label: is empty");
  description = large_robot();
  description.urdf.clear();
  EXPECT_EQ(message(description), "URDF: text is empty");
  description = large_robot();
  description.urdf.resize(kMaxUrdfBytes + 1, ' ');
  EXPECT_EQ(read_chain(description).error().code, ErrorCode::TooLarge);
  description = large_robot();
  description.T_tip_transfer.translation().x() = 2000;
  EXPECT_EQ(message(description), "transfer frame: coordinate 2000 m exceeds 1000 m");
  description = large_robot();
  description.task_axes.matters.fill(false);
  EXPECT_EQ(message(description), "task axes: none matters, need at least one");
  description = large_robot();
  for (std::size_t i = 0; i <= kMaxHeldJoints; ++i)
    description.held_joints["h" + std::to_string(i)] = 0;
  EXPECT_EQ(message(description), "held joints: 65 exceed 64");
}

TEST(VelocityLimits, AreThoseOfTheChainAndZeroWhereThereIsNone) {
  const RobotModel robot = read_model(large_robot()).value_or_throw();
  EXPECT_EQ(velocity_limits(robot), Eigen::Vector2d(0, 1));
}

TEST(ReadChain, LabelsAndLinkNamesDoNotCountForTheIdentity) {
  RobotDescription description = two_joints("continuous", kAlongZ);
  const Digest digest = read_chain(description).value_or_throw().digest();
  description.label = "other";
  EXPECT_EQ(read_chain(description).value_or_throw().digest(), digest);
  const std::string::size_type mid = description.urdf.find("'mid'");
  ASSERT_NE(mid, std::string::npos);
  std::string renamed = description.urdf;
  for (auto at = renamed.find("'mid'"); at != std::string::npos; at = renamed.find("'mid'"))
    renamed.replace(at, 5, "'new'");
  description.urdf = renamed;
  EXPECT_EQ(read_chain(description).value_or_throw().digest(), digest);
}

}  // namespace
}  // namespace kinship::kinematics::urdf_test
