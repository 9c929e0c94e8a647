#include "robots/kinematics/same_arm.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "robots/kinematics/urdf.hpp"
#include "tests/support/chain_parts.hpp"
#include "tests/support/robots.hpp"

// The UR10e against twins as fleets have them: calibrated, remounted, turned, renamed.
namespace kinship::same_arm_test {
namespace {

using kinematics::ArmLikeness;
using kinematics::Chain;
using kinematics::ChainParts;
using kinematics::compare_arms;
using kinematics::Joint;

class Ur10eTwin : public testing::Test {
 protected:
  ArmLikeness likeness() const { return compare_arms(ur10e_, Chain(twin_)); }

  Chain ur10e_ = test::model_chain("ur10e");
  ChainParts twin_ = test::parts_of(ur10e_);
};

TEST_F(Ur10eTwin, OffsetsOfAMillimetreAreNear) {
  for (Joint& joint : twin_.joints)
    joint.T_previous_joint.translation().x() += 0.7e-3;
  EXPECT_EQ(likeness(), ArmLikeness::Near);
}

TEST_F(Ur10eTwin, AnOffsetOfTwentyMillimetresIsAnotherArm) {
  for (std::size_t i = 0; i < twin_.joints.size(); ++i) {
    twin_ = test::parts_of(ur10e_);
    twin_.joints[i].T_previous_joint.translation().y() += 20e-3;
    EXPECT_EQ(likeness(), ArmLikeness::Different) << i;
  }
}

TEST_F(Ur10eTwin, CalibratedUnitsAreNear) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> noise(0, 3e-4);
  for (int unit = 0; unit < 50; ++unit) {
    twin_ = test::parts_of(ur10e_);
    for (Joint& joint : twin_.joints) {
      joint.T_previous_joint.translation() +=
          Eigen::Vector3d(noise(generator), noise(generator), noise(generator));
      joint.T_previous_joint.rotate(Eigen::AngleAxisd(noise(generator), Eigen::Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(noise(generator), Eigen::Vector3d::UnitY()));
    }
    EXPECT_EQ(likeness(), ArmLikeness::Near);
  }
}

TEST_F(Ur10eTwin, ATurnedAxisIsAnotherArm) {
  for (std::size_t i = 0; i < twin_.joints.size(); ++i) {
    twin_ = test::parts_of(ur10e_);
    twin_.joints[i].axis = -twin_.joints[i].axis;
    EXPECT_EQ(likeness(), ArmLikeness::Different) << i;
  }
}

TEST_F(Ur10eTwin, AnotherOrderOfJointsIsAnotherArm) {
  std::reverse(twin_.joints.begin(), twin_.joints.end());
  EXPECT_EQ(likeness(), ArmLikeness::Different);
}

TEST_F(Ur10eTwin, AnotherGripperIsAnotherArmFromFiveMillimetresOn) {
  twin_.T_tip_transfer.translation().z() += 4e-3;
  EXPECT_EQ(likeness(), ArmLikeness::Near);
  twin_.T_tip_transfer.translation().z() += 2e-3;
  EXPECT_EQ(likeness(), ArmLikeness::Different);
}

TEST_F(Ur10eTwin, OtherNamesAndMoreDigitsAreTheSameArm) {
  RobotDescription renamed = test::model_description("ur10e");
  const auto replace = [&](const std::string& from, const std::string& to) {
    renamed.urdf = std::regex_replace(renamed.urdf, std::regex(from), to);
  };
  replace("forearm_link", "unterarm");
  replace("elbow_joint", "ellbogen");
  replace("1\\.570796327", "1.5707963267948966");
  renamed.never_colliding.clear();
  const Chain twin = kinematics::read_chain(renamed).value_or_throw();
  EXPECT_GE(twin.find_link("unterarm"), 0);
  EXPECT_EQ(compare_arms(ur10e_, twin), ArmLikeness::Exact);
}

TEST(ModelArms, AreAllDifferent) {
  const std::vector<std::string> names = {"panda",       "iiwa14",     "iiwa7",       "ur10e",
                                          "sawyer",      "sara_like",  "planar_5r_a", "planar_5r_b",
                                          "planar_7r_c", "panda_lift", "iiwa14_lift"};
  std::vector<Chain> chains;
  for (const std::string& name : names)
    chains.push_back(test::model_chain(name));
  for (std::size_t i = 0; i < chains.size(); ++i)
    for (std::size_t j = 0; j < chains.size(); ++j)
      EXPECT_EQ(compare_arms(chains[i], chains[j]),
                i == j ? ArmLikeness::Exact : ArmLikeness::Different)
          << names[i] << ' ' << names[j];
}

}  // namespace
}  // namespace kinship::same_arm_test
