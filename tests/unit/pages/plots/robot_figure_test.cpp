#include "pages/plots/robot_figure.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <nlohmann/json.hpp>

#include "tests/support/robots.hpp"

namespace kinship::plots::robot_figure_test {
namespace {

using nlohmann::json;

RobotFigure figure_of(const std::string& model) {
  return robot_figure({.label = model}, kinship::test::model_description(model));
}

TEST(RobotFigure, EverySolidStandsAtItsLink) {
  const RobotFigure figure = figure_of("ur10e");
  const json data = json::parse(to_json(figure));
  std::size_t solids = 0;
  for (const json& link : data["robot"]["links"])
    for (const json& solid : link["solids"]) {
      ++solids;
      EXPECT_EQ(solid["name"], link["name"]);
    }
  EXPECT_EQ(solids, figure.drawn.robot.shapes.shapes.size());
  EXPECT_GT(solids, 5U);
}

TEST(RobotFigure, ItsChainIsTheRobots) {
  const kinematics::Chain chain = kinship::test::model_chain("panda_lift");
  const json robot = json::parse(to_json(figure_of("panda_lift")))["robot"];
  ASSERT_EQ(robot["joints"].size(), 8U);
  EXPECT_EQ(robot["joints"][0]["type"], "prismatic");
  EXPECT_EQ(robot["joints"][0]["unit"], "m");
  EXPECT_EQ(robot["joints"][1]["type"], "revolute");
  EXPECT_NEAR(robot["joints"][1]["upper"], chain.upper()(1), 1e-7);
  EXPECT_EQ(robot["digest"], chain.digest().hex());
}

TEST(RobotFigure, IsFirstShownWhereItDoesNotTouchItself) {
  for (const char* const model : {"panda", "ur10e", "iiwa14", "planar_5r_a"}) {
    const RobotFigure figure = figure_of(model);
    EXPECT_FALSE(figure.touches_itself) << model;
    EXPECT_TRUE(figure.drawn.robot.chain.within_limits(figure.shown)) << model;
  }
}

}  // namespace
}  // namespace kinship::plots::robot_figure_test
