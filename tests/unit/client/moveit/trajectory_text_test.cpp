#include "client/moveit/trajectory_text.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <stdexcept>

#include "client/moveit/message_members.hpp"
#include "robots/models/robot_arguments.hpp"
#include "tests/support/places.hpp"

namespace kinship::moveit::trajectory_text_test {
namespace {

using namespace std::chrono_literals;

kinematics::RobotModel panda() {
  auto described = models::describe_robot({.source = test::source_dir() + "/robots/models/panda"});
  return models::read_model(*std::move(described)).value_or_throw();
}

kinematics::TimedPath two_points() {
  kinematics::TimedPath path;
  path.configurations = Eigen::MatrixXd::Zero(7, 2);
  path.configurations.col(1) << 1, 1e-7, -0.25, -2, 0, 1.5, 3e20;
  path.times = {0ns, 12'000'000'034ns};
  return path;
}

TEST(TrajectoryText, HasTheMembersOfTheMessagesInTheirOrder) {
  const std::string text = display_trajectory_text(panda(), two_points(), "a\nb");
  EXPECT_EQ(text.substr(0, text.find('\n')), "# a?b");
  const YamlValue message = YamlValue::of_document(YAML::Load(text), "shown.yaml");
  EXPECT_NO_THROW(check_members(message, "DisplayTrajectory"));
  const YamlValue points = message["trajectory"].items().at(0)["joint_trajectory"]["points"];
  EXPECT_EQ(points.items().at(1)["time_from_start"]["sec"].number(), 12);
  EXPECT_EQ(points.items().at(1)["time_from_start"]["nanosec"].number(), 34);
  const auto names = message["trajectory_start"]["joint_state"]["name"].items();
  EXPECT_EQ(names.at(6).text(), "panda_joint7");
  EXPECT_GT(names.size(), 7U) << "held joints";
}

TEST(TrajectoryText, NumbersAreFloatsForYaml11) {
  const std::string text = robot_trajectory_text(panda(), two_points(), "");
  EXPECT_NE(text.find("[1.0, 1.0e-07, -0.25, -2.0, 0.0, 1.5, 3.0e+20]"), std::string::npos) << text;
}

TEST(TrajectoryText, NamesAreQuotedForTheyMayLookLikeNumbers) {
  kinematics::RobotModel robot = panda();
  kinematics::ChainParts parts = robot.chain.parts();
  parts.joints[0].name = "1.5";
  parts.joints[1].name = "on";
  robot.chain = kinematics::Chain(parts);
  const std::string text = display_trajectory_text(robot, two_points(), "");
  EXPECT_NE(text.find("[\"1.5\", \"on\", \"panda_joint3\""), std::string::npos) << text;
  EXPECT_NE(text.find("model_id: \"panda\""), std::string::npos) << text;
  EXPECT_NE(text.find("velocities: []"), std::string::npos) << text;
}

TEST(TrajectoryText, RefusesThePathOfAnotherRobot) {
  kinematics::TimedPath path = two_points();
  path.configurations.conservativeResize(6, 2);
  EXPECT_THROW(robot_trajectory_text(panda(), path, ""), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::moveit::trajectory_text_test
