#include "robots/kinematics/chain.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>

#include "proto/types/limits.hpp"
#include "tests/unit/robots/kinematics/random_chains.hpp"

namespace kinship::kinematics::chain_test {
namespace {

constexpr std::uint64_t kSeed = 7;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ChainParts parts(int dof = 6) {
  std::mt19937_64 generator(kSeed);
  return random_parts(dof, generator);
}

std::string fault_after(const std::function<void(ChainParts&)>& change) {
  ChainParts changed = parts();
  change(changed);
  EXPECT_THROW(Chain{changed}, std::invalid_argument);
  return validate(changed).value_or("none");
}

TEST(Chain, RefusesPartsThatAreNoChainAndNamesThem) {
  EXPECT_EQ(fault_after([](auto& p) { p.joints.clear(); }), "chain: no moving joint");
  EXPECT_EQ(fault_after([](auto& p) { p.joints.resize(kMaxDof + 1, p.joints[0]); }),
            "chain: 33 moving joints exceed 32");
  EXPECT_NE(fault_after([](auto& p) { p.joints[2].axis *= 2; }).find("'joint_3': axis"),
            std::string::npos);
  EXPECT_EQ(fault_after([](auto& p) { p.joints[0].upper = -2; }),
            "joint 'joint_1': lower limit -1 is not below upper limit -2");
  EXPECT_NE(fault_after([](auto& p) { p.joints[0].lower = kNan; }).find("limit nan"),
            std::string::npos);
  EXPECT_NE(fault_after([](auto& p) { p.joints[0].upper = 1e16; }).find("exceeds 1000"),
            std::string::npos);
  EXPECT_EQ(fault_after([](auto& p) { p.T_tip_transfer.translation().x() = kNan; }),
            "transfer frame: pose is not finite");
  EXPECT_NE(fault_after([](auto& p) { p.T_last_tip.translation().y() = -1001; }).find("1001"),
            std::string::npos);
  EXPECT_NE(fault_after([](auto& p) {
              p.joints[1].T_previous_joint.linear() *= 1.001;
            }).find("not a rotation"),
            std::string::npos);
  EXPECT_NE(fault_after([](auto& p) { p.T_last_tip.linear().col(0) *= -1; }).find("not a rotation"),
            std::string::npos);
  EXPECT_NE(fault_after([](auto& p) { p.task_axes.matters.fill(false); }).find("task axes"),
            std::string::npos);
  EXPECT_NE(fault_after([](auto& p) { p.links[1].joint = 6; }).find("joint index 6"),
            std::string::npos);
  EXPECT_NE(fault_after([](auto& p) { p.links[1].parent = 1; }).find("parent index 1"),
            std::string::npos);
}

TEST(Chain, ContinuousJointsHaveTheLimitsOfOneTurn) {
  const Chain chain(parts());
  ASSERT_EQ(chain.joints()[1].type, JointType::Continuous);
  EXPECT_EQ(chain.lower()[1], -std::numbers::pi);
  EXPECT_EQ(chain.joints()[1].upper, std::numbers::pi);
}

TEST(Chain, WithinLimitsCountsTheToleranceAndIgnoresContinuousJoints) {
  const Chain chain(parts(3));  // revolute [-1, 2], continuous, prismatic [-3, 4]
  EXPECT_TRUE(chain.within_limits(Eigen::Vector3d(2, 100, 4)));
  EXPECT_FALSE(chain.within_limits(Eigen::Vector3d(2.01, 0, 0)));
  EXPECT_TRUE(chain.within_limits(Eigen::Vector3d(2.01, 0, -3.01), 0.02));
  EXPECT_FALSE(chain.within_limits(Eigen::Vector3d(0, kNan, 0)));
  EXPECT_FALSE(chain.within_limits(Eigen::Vector3d(kNan, 0, 0)));
  EXPECT_THROW(chain.within_limits(Eigen::Vector2d(0, 0)), std::invalid_argument);
}

TEST(Chain, FindsLinksByName) {
  const Chain chain(parts(3));
  EXPECT_EQ(chain.find_link("link_2"), 2);
  EXPECT_EQ(chain.find_link("link_4"), -1);
}

TEST(ChainDigest, IgnoresNamesAndLinks) {
  ChainParts renamed = parts();
  renamed.base_link = renamed.tip_link = "other";
  for (Joint& joint : renamed.joints)
    joint.name += "_other";
  renamed.links.clear();
  EXPECT_EQ(Chain(renamed).digest(), Chain(parts()).digest());
}

TEST(ChainDigest, IgnoresTheLastBitsAndTheLimitsOfContinuousJoints) {
  ChainParts nudged = parts();
  nudged.joints[0].T_previous_joint.translation() += Eigen::Vector3d::Constant(1e-15);
  nudged.joints[1].lower = -1;
  EXPECT_EQ(Chain(nudged).digest(), Chain(parts()).digest());
}

TEST(ChainDigest, DependsOnEveryNumber) {
  const Digest original = Chain(parts()).digest();
  const std::vector<std::function<void(ChainParts&)>> changes = {
      [](auto& p) { p.joints[0].type = JointType::Prismatic; },
      [](auto& p) { p.joints[0].lower -= 1e-6; },
      [](auto& p) { p.joints[5].upper += 1e-6; },
      [](auto& p) { p.T_last_tip.translation().z() += 1e-6; },
      [](auto& p) { p.T_last_tip.rotate(Eigen::AngleAxisd(1e-6, Eigen::Vector3d::UnitY())); },
      [](auto& p) { p.T_tip_transfer.translation().x() += 1e-6; },
      [](auto& p) { p.T_tip_transfer.rotate(Eigen::AngleAxisd(1e-6, Eigen::Vector3d::UnitX())); },
      [](auto& p) { p.task_axes.matters[3] = false; },
      [](auto& p) { p.joints.pop_back(), p.links.pop_back(); }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    ChainParts changed = parts();
    changes[i](changed);
    EXPECT_NE(Chain(changed).digest(), original) << "change " << i;
  }
  for (std::size_t joint = 0; joint < parts().joints.size(); ++joint)
    for (Eigen::Index k = 0; k < 3; ++k) {
      ChainParts moved = parts(), turned = parts(), tilted = parts();
      const Eigen::AngleAxisd turn(1e-6, Eigen::Vector3d::Unit(k));
      moved.joints[joint].T_previous_joint.translation()[k] += 1e-6;
      turned.joints[joint].T_previous_joint.rotate(turn);
      tilted.joints[joint].axis = turn * tilted.joints[joint].axis;
      for (const ChainParts& changed : {moved, turned, tilted})
        EXPECT_NE(Chain(changed).digest(), original) << "joint " << joint << ", axis " << k;
    }
}

}  // namespace
}  // namespace kinship::kinematics::chain_test
