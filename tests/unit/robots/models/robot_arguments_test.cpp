#include "robots/models/robot_arguments.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/support/temporary_directory.hpp"

namespace kinship::models::robot_arguments_test {
namespace {

const std::string kModels = std::string(KINSHIP_SOURCE_DIR) + "/robots/models/";

TEST(ParsePose, TakesSevenNumbers) {
  const auto pose = parse_pose("0.1 -2, 3e-1  0 0 0 1");
  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->translation().isApprox(Eigen::Vector3d(0.1, -2, 0.3)));
}

TEST(ParsePose, NamesWhatIsWrong) {
  EXPECT_NE(parse_pose("1 2 3").error().message.find("has 3 numbers"), std::string::npos);
  EXPECT_NE(parse_pose("1 2 x 0 0 0 1").error().message.find("'x' is no number"),
            std::string::npos);
  EXPECT_FALSE(parse_pose("1 2 nan 0 0 0 1"));
}

TEST(DescribeRobot, RefusesWhatIsNoAxis) {
  const auto robot = describe_robot({.source = kModels + "panda", .axes = "x,w"});
  ASSERT_FALSE(robot);
  EXPECT_EQ(robot.error().message, "--axes: 'w' is not one of x, y, z, roll, pitch, yaw");
}

TEST(DescribeRobot, ArgumentsReplaceWhatTheFolderSays) {
  const auto folder = describe_robot({.source = kModels + "panda"});
  ASSERT_TRUE(folder) << folder.error().message;
  EXPECT_EQ(folder->label, "panda");
  const auto renamed = describe_robot({.source = kModels + "panda", .label = "cell3"});
  ASSERT_TRUE(renamed);
  EXPECT_EQ(renamed->label, "cell3");
  EXPECT_EQ(renamed->tip_link, folder->tip_link);
}

/// What is wrong with a URDF file of this name and text.
std::string complaint(const std::string& name, const std::string& text) {
  const test::TemporaryDirectory directory;
  std::ofstream(directory.path() / name) << text;
  const auto robot =
      describe_robot({.source = directory.path() / name, .base_link = "a", .tip_link = "a"});
  return robot ? "" : robot.error().message;
}

TEST(DescribeRobot, AFileWhoseNameIsNoLabelNeedsAnother) {
  EXPECT_EQ(complaint("arm.urdf", "<robot name='r'><link name='a'/></robot>"), "");
  EXPECT_NE(complaint("my arm.urdf", "<robot name='r'><link name='a'/></robot>").find("--label"),
            std::string::npos);
}

TEST(DescribeRobot, AXacroFileIsToldToBeOne) {
  EXPECT_NE(complaint("arm.xacro", "<robot name='r'><xacro:include filename='b'/></robot>")
                .find("is a xacro file"),
            std::string::npos);
  EXPECT_EQ(complaint("arm.urdf", "<robot name='r'><!-- <xacro:arm/> --><link name='a'/></robot>"),
            "");
}

TEST(DescribeRobot, RefusesAHeldJointWithoutValue) {
  const auto robot = describe_robot({.source = kModels + "panda", .held = {"finger"}});
  ASSERT_FALSE(robot);
  EXPECT_NE(robot.error().message.find("JOINT=VALUE"), std::string::npos);
}

}  // namespace
}  // namespace kinship::models::robot_arguments_test
