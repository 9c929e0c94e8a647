#include "pages/plots/robot_figure.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <nlohmann/json.hpp>

#include "proto/types/base64.hpp"
#include "tests/support/box_mesh.hpp"
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

TEST(RobotFigure, MeshesAreDrawnWhoseContentsAreHere) {
  const TriangleMesh mesh =
      TriangleMesh::from_corners(kinship::test::BoxMesh({0.3, 0.04, 0.04}).triangles())
          .value_or_throw();
  RobotDescription arm;
  arm.label = "arm";
  arm.urdf =
      "<robot name='arm'><link name='base'/><link name='bar'><collision><geometry>"
      "<mesh filename='bar.stl'/></geometry></collision></link>"
      "<joint name='j' type='revolute'><parent link='base'/><child link='bar'/>"
      "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";
  arm.base_link = "base";
  arm.tip_link = "bar";
  arm.mesh_solids.solids = {{"bar", SphereShape{0.2}}};
  arm.meshes = {
      {"bar", MeshRole::Both, Eigen::Isometry3d::Identity(), {1, 0.5, 0, 1}, 0, mesh.digest()},
      {"base", MeshRole::Visual, Eigen::Isometry3d::Identity(), {}, 0.001, Digest()}};
  const MeshContent content = mesh.content();
  const std::vector<StoredMesh> stored = {{mesh.digest(), content.bytes, to_base64(content.zlib)},
                                          {Digest(), 100, "not base 64!"}};
  const json robot = json::parse(to_json(robot_figure({.label = "arm"}, arm, stored)))["robot"];
  ASSERT_EQ(robot["meshes"].size(), 1U) << "the other's content is none";
  EXPECT_EQ(robot["links"][robot["meshes"][0]["link"].get<std::size_t>()]["name"], "bar");
  EXPECT_EQ(robot["meshes"][0]["role"], "both");
  EXPECT_EQ(robot["meshes"][0]["rgba"], json({1, 0.5, 0, 1}));
  ASSERT_EQ(robot["contents"].size(), 1U);
  EXPECT_EQ(robot["contents"][mesh.digest().hex()], to_base64(mesh.canonical()));
  EXPECT_EQ(robot["shapes"], "1 link by the triangles of their meshes");
  std::size_t solids = 0;
  for (const json& link : robot["links"])
    solids += link["solids"].size();
  EXPECT_EQ(solids, 1U) << "those around meshes are there to be shown, too";
}

}  // namespace
}  // namespace kinship::plots::robot_figure_test
