#include "client/arguments/command_options.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

namespace kinship::arguments::robot_options_test {
namespace {

using Words = std::vector<std::string>;

TEST(RobotOptions, FillTheArguments) {
  models::RobotArguments robot;
  std::string rest;
  CLI::App app;
  add_robot_options(app, robot);
  app.add_option("rest", rest);
  app.parse(
      "--base b --tip t --label l --transfer \"0 0 1 0 0 0 1\" --axes x,y --hold a=1 --hold b=2 "
      "--srdf s.srdf --package p=/p --package q=/q "
      "--collision-from-visual --without-collision c --without-collision d more");
  EXPECT_EQ(robot.base_link, "b");
  EXPECT_EQ(robot.tip_link, "t");
  EXPECT_EQ(robot.label, "l");
  EXPECT_EQ(robot.transfer, "0 0 1 0 0 0 1");
  EXPECT_EQ(robot.axes, "x,y");
  EXPECT_EQ(robot.held, (Words{"a=1", "b=2"}));
  EXPECT_EQ(robot.srdf, "s.srdf");
  EXPECT_EQ(robot.packages, (Words{"p=/p", "q=/q"}));
  EXPECT_TRUE(robot.collision_from_visual);
  EXPECT_EQ(robot.without_collision, (Words{"c", "d"}));
  EXPECT_EQ(robot.source, "");
  EXPECT_EQ(rest, "more");  // a repeatable option takes one word at a time
}

TEST(RobotOptions, AreAllOptional) {
  models::RobotArguments robot;
  CLI::App app;
  add_robot_options(app, robot);
  app.parse("");
  EXPECT_TRUE(robot.held.empty());
  EXPECT_TRUE(robot.srdf.empty());
}

}  // namespace
}  // namespace kinship::arguments::robot_options_test
