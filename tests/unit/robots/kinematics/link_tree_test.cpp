#include "robots/kinematics/link_tree.hpp"

#include <gtest/gtest.h>

namespace kinship::kinematics::link_tree_test {
namespace {

using Names = std::vector<std::string>;

/// URDF text of links and joints; each joint is "parent child type" with what stands in it.
class Urdf {
 public:
  Urdf& link(const std::string& name, const std::string& inside = "") {
    text_ += "<link name='" + name + "'>" + inside + "</link>";
    return *this;
  }
  Urdf& joint(const std::string& parent, const std::string& child, const std::string& type,
              const std::string& inside = "<limit lower='-1' upper='2' effort='1' velocity='1'/>") {
    link(child);
    text_ += "<joint name='to_" + child + "' type='" + type + "'><parent link='" + parent +
             "'/><child link='" + child + "'/>" + inside + "</joint>";
    return *this;
  }
  std::vector<TreeLink> tree() const {
    return read_link_tree("<robot name='r'>" + text_ + "</robot>").value_or_throw();
  }

 private:
  std::string text_;
};

TEST(LinkTree, TellsJointsLimitsMimicsAndSolids) {
  const std::vector<TreeLink> tree =
      Urdf()
          .link("base",
                "<collision><geometry><box size='1 1 1'/></geometry></collision>"
                "<collision><geometry><mesh filename='a.stl'/></geometry></collision>")
          .joint("base", "arm", "revolute")
          .joint("arm", "finger", "prismatic",
                 "<mimic joint='to_arm'/><limit lower='0' upper='0.04' effort='1' velocity='1'/>")
          .tree();
  ASSERT_EQ(tree.size(), 3U);
  EXPECT_EQ(tree[0].name, "base");
  EXPECT_EQ(tree[0].parent, -1);
  EXPECT_EQ(tree[0].collision, (Names{"box", "mesh"}));
  EXPECT_EQ(tree[1].joint.name, "to_arm");
  EXPECT_EQ(tree[1].joint.type, "revolute");
  EXPECT_EQ(tree[1].joint.lower, -1);
  EXPECT_EQ(tree[1].joint.upper, 2);
  EXPECT_TRUE(tree[1].joint.moves());
  EXPECT_EQ(tree[2].parent, 1);
  EXPECT_EQ(tree[2].joint.mimics, "to_arm");
  EXPECT_FALSE(tree[2].joint.moves());
}

TEST(LinkTree, SaysWhatIsWrongWithATextThatIsNone) { EXPECT_FALSE(read_link_tree("<robot")); }

Urdf arm(int joints) {
  Urdf urdf;
  urdf.link("world").joint("world", "base_link", "fixed", "");
  std::string last = "base_link";
  for (int i = 1; i <= joints; ++i) {
    const std::string link = "link" + std::to_string(i);
    urdf.joint(last, link, "revolute");
    last = link;
  }
  return urdf;
}

TEST(SuggestEnds, OfAnArmWithAToolFrame) {
  const auto ends = suggest_ends(
      arm(6).joint("link6", "flange", "fixed", "").joint("flange", "tool0", "fixed", "").tree());
  ASSERT_EQ(ends.size(), 1U);
  EXPECT_EQ(ends[0].joints, 6U);
  EXPECT_EQ(ends[0].bases, (Names{"base_link", "world"}));
  EXPECT_EQ(ends[0].tips.front(), "tool0");
  EXPECT_EQ(ends[0].tips.size(), 3U);
}

TEST(SuggestEnds, FingersAreNoPartOfAnArm) {
  const auto ends = suggest_ends(arm(7)
                                     .joint("link7", "hand", "fixed", "")
                                     .joint("hand", "left", "prismatic")
                                     .joint("hand", "right", "prismatic")
                                     .tree());
  ASSERT_EQ(ends.size(), 1U);
  EXPECT_EQ(ends[0].joints, 7U);
  EXPECT_EQ(ends[0].tips, (Names{"hand", "link7"}));
}

TEST(SuggestEnds, TwoArmsOnATorsoAreTwo) {
  Urdf urdf = arm(1);
  for (const std::string side : {"left", "right"}) {
    std::string last = "link1";
    for (int i = 0; i < (side == "left" ? 3 : 4); ++i) {
      const std::string link = side + std::to_string(i);
      urdf.joint(last, link, "revolute");
      last = link;
    }
  }
  const auto ends = suggest_ends(urdf.tree());
  ASSERT_EQ(ends.size(), 2U);
  EXPECT_EQ(ends[0].joints, 5U);  // the one with most joints comes first
  EXPECT_EQ(ends[0].tips.front(), "right3");
  EXPECT_EQ(ends[1].tips.front(), "left2");
}

TEST(SuggestEnds, NothingThatMovesHasNone) { EXPECT_TRUE(suggest_ends(arm(0).tree()).empty()); }

std::string limits(double lower, double upper) {
  return "<limit lower='" + std::to_string(lower) + "' upper='" + std::to_string(upper) +
         "' effort='1' velocity='1'/>";
}

/// An arm of six joints and a palm.
Urdf with_palm() { return arm(6).joint("link6", "palm", "fixed", ""); }

void expect_palm_first(const std::vector<ChainEnds>& ends, const std::string& finger) {
  ASSERT_EQ(ends.size(), 2U);
  EXPECT_EQ(ends[0].joints, 6U);
  EXPECT_EQ(ends[0].tips.front(), "palm");
  EXPECT_EQ(ends[1].tips.front(), finger) << "the other tip is listed after it";
}

TEST(SuggestEnds, ASingleTurningJawIsNoPartOfAnArm) {
  expect_palm_first(
      suggest_ends(with_palm().joint("palm", "jaw", "revolute", limits(-1.5, 0)).tree()), "jaw");
  expect_palm_first(
      suggest_ends(with_palm().joint("palm", "mover", "revolute", limits(-1.5, 0)).tree()),
      "mover");
  expect_palm_first(
      suggest_ends(with_palm().joint("palm", "Gripper", "revolute", limits(-0.2, 1.7)).tree()),
      "Gripper");
}

TEST(SuggestEnds, ASingleShortSlideIsAFingerAndALongOneAnAxis) {
  expect_palm_first(
      suggest_ends(with_palm().joint("palm", "slide", "prismatic", limits(0, 0.04)).tree()),
      "slide");
  const auto scara =
      suggest_ends(arm(3).joint("link3", "quill", "prismatic", limits(-0.2, 0)).tree());
  ASSERT_EQ(scara.size(), 1U);
  EXPECT_EQ(scara[0].joints, 4U);
}

TEST(SuggestEnds, AFingerThatAnotherOneFollowsElsewhereIsNoPartOfAnArm) {
  expect_palm_first(suggest_ends(with_palm()
                                     .joint("palm", "driver", "revolute", limits(-1, 2))
                                     .joint("base_link", "follower", "revolute",
                                            "<mimic joint='to_driver'/>" + limits(-1, 2))
                                     .tree()),
                    "driver");
}

TEST(SuggestEnds, AWristIsPartOfAnArmWhateverItIsNamed) {
  const auto ends = suggest_ends(arm(6).joint("link6", "gripper_roll", "continuous", "").tree());
  ASSERT_EQ(ends.size(), 1U);
  EXPECT_EQ(ends[0].joints, 7U);
}

TEST(SuggestEnds, FingersOfManyJointsAreAHandAndNoArms) {
  Urdf urdf = with_palm();
  for (const std::string finger : {"index", "middle", "thumb"}) {
    std::string last = "palm";
    for (int i = 0; i < 4; ++i) {
      const std::string link = finger + std::to_string(i);
      urdf.joint(last, link, "revolute");
      last = link;
    }
  }
  const auto ends = suggest_ends(urdf.tree());
  ASSERT_EQ(ends.size(), 1U);
  EXPECT_EQ(ends[0].joints, 6U);
  EXPECT_EQ(ends[0].tips.front(), "palm");
}

TEST(LinkTree, GoesOnWhereAJointIsWrongAndSaysWhy) {
  const auto tree = arm(2).joint("link2", "finger", "prismatic", limits(0.5, 0.25)).tree();
  EXPECT_EQ(tree.back().joint.fault, "lower limit 0.5 exceeds upper limit 0.25");
  EXPECT_EQ(tree[2].joint.fault, "");
}

TEST(MobileBase, IsToldByWheelsAndByPlanarOrFloatingJoints) {
  EXPECT_TRUE(describe_mobile_base(with_palm().tree()).empty());
  Urdf urdf;
  urdf.link("odom").joint("odom", "base_link", "planar", "");
  for (const std::string wheel : {"left_wheel", "right_wheel"})
    urdf.joint("base_link", wheel, "continuous", "");
  const auto said = describe_mobile_base(urdf.tree());
  ASSERT_EQ(said.size(), 2U);
  EXPECT_NE(said[0].find("'to_base_link' (planar)"), std::string::npos) << said[0];
  EXPECT_NE(said[1].find("'to_left_wheel', 'to_right_wheel'"), std::string::npos) << said[1];
  EXPECT_TRUE(suggest_ends(urdf.tree()).empty()) << "wheels make no arm";
}

TEST(LinkTree, ACameraAtTheHandIsNoTip) {
  const auto ends = suggest_ends(arm(6)
                                     .joint("link6", "grasp_center", "fixed", "")
                                     .joint("link6", "camera_link", "fixed", "")
                                     .joint("camera_link", "infra2_optical_frame", "fixed", "")
                                     .tree());
  ASSERT_EQ(ends.size(), 1U);
  EXPECT_EQ(ends[0].tips, (Names{"grasp_center", "link6", "infra2_optical_frame", "camera_link"}));
}

TEST(MobileBase, CounterweightsThatFollowAJointAreNoWheels) {
  Urdf urdf;
  urdf.link("base").joint("base", "arm", "revolute", limits(-1, 1));
  for (const std::string side : {"left", "right"})
    urdf.joint("base", side, "continuous", "<mimic joint=\"to_arm\" multiplier=\"0.2\"/>");
  EXPECT_TRUE(describe_mobile_base(urdf.tree()).empty());
}

}  // namespace
}  // namespace kinship::kinematics::link_tree_test
