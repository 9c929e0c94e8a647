#include "proto/json/robot_description_json.hpp"

#include <gtest/gtest.h>

#include <string>

namespace kinship::json::robot_description_json_test {
namespace {

RobotDescription planar_arm() {
  RobotDescription description;
  description.label = "planar-3";
  description.urdf = "<robot name=\"p\">\n  <link name=\"a\"/>\n</robot>";
  description.base_link = "base";
  description.tip_link = "tip";
  description.task_axes.matters = {true, true, false, false, false, true};
  description.held_joints = {{"lift", 0.25}, {"head", -1}};
  description.never_colliding = {{"a", "b"}, {"b", "c"}};
  return description;
}

TEST(RobotDescriptionJson, MeshSolidsAreReadBackAndLeftOutWhereThereAreNone) {
  RobotDescription written = planar_arm();
  EXPECT_EQ(to_json(written).find("mesh_solids"), std::string::npos);
  written.mesh_solids.solids = {{"a", CylinderShape{0.1, 0.2}}, {"b", SphereShape{0.4}}};
  written.mesh_solids.unfiltered = {{"a", "b"}};
  const auto back = robot_description_from_json(to_json(written));
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_EQ(back->mesh_solids.solids.size(), 2U);
  EXPECT_EQ(back->mesh_solids.solids[0].link, "a");
  EXPECT_EQ(std::get<CylinderShape>(back->mesh_solids.solids[0].shape).length_m, 0.2);
  EXPECT_EQ(back->mesh_solids.unfiltered, written.mesh_solids.unfiltered);
}

TEST(RobotDescriptionJson, AxesAreWrittenByName) {
  EXPECT_NE(to_json(planar_arm()).find(R"("task_axes":["x","y","yaw"])"), std::string::npos);
  const auto refused = robot_description_from_json(
      R"({"label": "a", "urdf": "", "base_link": "b", "tip_link": "t", "task_axes": ["w"]})");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "task_axes: 'w' is not one of x, y, z, roll, pitch, yaw");
}

TEST(RobotDescriptionJson, AllAxesMatterIfNothingIsSaid) {
  const auto read = robot_description_from_json(
      R"({"label": "a", "urdf": "", "base_link": "b", "tip_link": "t"})");
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->task_axes.all());
}

TEST(RobotDescriptionJson, SizesAreLimited) {
  RobotDescription description = planar_arm();
  description.urdf.assign(1'000'001, ' ');
  EXPECT_EQ(robot_description_from_json(to_json(description)).error().message,
            "urdf: 1000001 bytes exceed 1000000");
  description = planar_arm();
  for (int i = 0; i < 64; ++i)
    description.held_joints["joint_" + std::to_string(i)] = 0;
  EXPECT_EQ(robot_description_from_json(to_json(description)).error().message,
            "held_joints: 66 members exceed 64");
}

}  // namespace
}  // namespace kinship::json::robot_description_json_test
