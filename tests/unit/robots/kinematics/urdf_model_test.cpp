#include "robots/kinematics/urdf_model.hpp"

#include <console_bridge/console.h>
#include <gtest/gtest.h>
#include <urdf_model/model.h>

#include <locale>
#include <thread>

#include "tests/unit/robots/kinematics/small_arm.hpp"

namespace kinship::kinematics::urdf_model_test {
namespace {

std::string message(const std::string& text) {
  const auto model = parse_urdf(text);
  return model ? "fine" : model.error().message;
}

/// A robot whose lower limit is written as `value`.
std::string with_lower_limit(const std::string& value) {
  return robot_text("base tip",
                    joint_text("j1", "revolute", "base", "tip",
                               "<limit lower='" + value + "' upper='1' effort='1' velocity='1'/>"));
}

TEST(UrdfModel, ReadsATree) {
  const auto model = parse_urdf(two_joints("fixed", "").urdf);
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->tree->links_.size(), 3U);
  EXPECT_EQ(model->tree->getRoot()->name, "base");
}

TEST(UrdfModel, RefusesNumbersThatAreNotFiniteDecimals) {
  for (const std::string value : {"nan", "inf", "1e999", "1,5", "1 2", "one", ""})
    EXPECT_NE(message(with_lower_limit(value)).find("j1"), std::string::npos) << value;
  EXPECT_EQ(message(with_lower_limit("0.5")), "fine");
}

/// Every attribute of several numbers, with `between` between them.
std::string with_numbers_parted_by(const std::string& between) {
  const auto numbers = [&](const std::string& a, const std::string& b, const std::string& c) {
    return "'" + a + between + b + between + c + "'";
  };
  const std::string box = "<geometry><box size=" + numbers("1", "2", "3") + "/></geometry>";
  const std::string mesh =
      "<geometry><mesh filename='a.stl' scale=" + numbers("2", "3", "4") + "/></geometry>";
  return "<robot name='r'><!-- it's one --><link name='base'><collision><origin xyz=" +
         numbers("1", "2", "3") + " rpy=" + numbers("0", "0", "0.5") + "/>" + box +
         "</collision></link><link name='tip'><collision>" + mesh +
         "</collision></link><joint name='j1' type='revolute'><origin xyz=" +
         numbers("4", "5", "6") + "/><axis xyz=" + numbers("0", "1", "0") +
         "/><parent link='base'/><child link='tip'/>"
         "<limit lower='0' upper='1' effort='1' velocity='1'/></joint></robot>";
}

TEST(UrdfModel, TabsAndLineBreaksBetweenNumbersAreBlanks) {
  for (const std::string between : {" ", "\t", "\n", "\r\n", " \t ", "\n      "}) {
    const auto model = parse_urdf(with_numbers_parted_by(between));
    ASSERT_TRUE(model) << model.error().message;
    const auto& joint = *model->tree->getJoint("j1");
    EXPECT_EQ(joint.axis.y, 1);
    EXPECT_EQ(joint.parent_to_joint_origin_transform.position.z, 6);
    const auto& base = *model->tree->getLink("base")->collision;
    EXPECT_EQ(base.origin.position.y, 2);
    EXPECT_EQ(dynamic_cast<const urdf::Box&>(*base.geometry).dim.z, 3);
    const auto& tip = *model->tree->getLink("tip")->collision;
    EXPECT_EQ(dynamic_cast<const urdf::Mesh&>(*tip.geometry).scale.x, 2);
  }
}

/// Writes and reads numbers as in "1.234,5".
struct CommaPunctuation : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(UrdfModel, ReadsNumbersAlikeInEveryLocale) {
  const std::locale before =
      std::locale::global(std::locale(std::locale::classic(), new CommaPunctuation));
  const auto model = parse_urdf(with_lower_limit("0.5"));
  std::locale::global(before);
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->tree->getJoint("j1")->limits->lower, 0.5);
}

TEST(UrdfModel, SaysInTheParsersWordsWhatIsWrong) {
  EXPECT_NE(message("not XML at all"), "fine");
  EXPECT_NE(message("<robot name='r'/>").find("No link elements"), std::string::npos);
  const std::string unlimited = robot_text("base tip", joint_text("j1", "revolute", "base", "tip"));
  EXPECT_NE(message(unlimited).find("does not specify limits"), std::string::npos);
  const std::string orphan = robot_text("base tip", joint_text("j1", "fixed", "base", "hand"));
  EXPECT_NE(message(orphan).find("hand"), std::string::npos);
}

TEST(UrdfModel, RefusesLinksThatFormNoTree) {
  const std::string two_parents =
      robot_text("base a b tip",
                 joint_text("j1", "fixed", "base", "a") + joint_text("j2", "fixed", "base", "b") +
                     joint_text("j3", "fixed", "a", "tip") + joint_text("j4", "fixed", "b", "tip"));
  EXPECT_EQ(message(two_parents), "URDF: 4 joints for 4 links do not form a tree");
  const std::string circle = robot_text(
      "base a b", joint_text("j1", "fixed", "a", "b") + joint_text("j2", "fixed", "b", "a"));
  EXPECT_EQ(message(circle), "URDF: links do not form a tree below 'base'");
}

TEST(UrdfModel, RefusesLongNames) {
  EXPECT_EQ(message(robot_text(std::string(129, 'x'), "")),
            "URDF: link: name of 129 bytes exceeds 128");
}

TEST(UrdfModel, RefusesControlCharactersThatReferencesBringIn) {
  EXPECT_EQ(message(robot_text("ba&#27;[31mse", "")),
            "URDF: link 'ba?[31mse': byte 3 of the name is a control character");
  EXPECT_EQ(message(robot_text("base&#10;2026-01-01 info all&#x20;is&#x20;well", "")).find('\n'),
            std::string::npos);
  const std::string joint = joint_text("j&#x1b;1", "fixed", "base", "tip");
  EXPECT_EQ(message(robot_text("base tip", joint)),
            "URDF: joint 'j?1': byte 2 of the name is a control character");
  // What the parser itself complains of is cited before names are checked.
  const std::string orphan =
      message(robot_text("base tip", joint_text("j1", "fixed", "base", "ha&#27;nd&#10;")));
  for (const char c : orphan)
    EXPECT_GE(static_cast<unsigned char>(c), 0x20) << orphan;
}

TEST(UrdfModel, PrintsNothingAndLeavesTheMessagesOfOthersAlone) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  EXPECT_NE(message("<robot/>"), "fine");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  testing::internal::CaptureStderr();
  CONSOLE_BRIDGE_logError("of another");
  EXPECT_NE(testing::internal::GetCapturedStderr().find("of another"), std::string::npos);
}

TEST(UrdfModel, ThreadsGetTheirOwnMessages) {
  const auto complain = [](const std::string& value) {
    for (int i = 0; i < 200; ++i) {
      const std::string text = message(with_lower_limit(value));
      ASSERT_NE(text.find(value), std::string::npos) << text;
    }
  };
  std::thread other(complain, "first");
  complain("second");
  other.join();
}

}  // namespace
}  // namespace kinship::kinematics::urdf_model_test
