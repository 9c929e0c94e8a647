#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "client/moveit/conversion.hpp"
#include "robots/models/loaded_robot.hpp"
#include "tests/support/temporary_directory.hpp"

/// Scenes and requests as MoveIt's tools write them, and what is asked of their conversion.
namespace kinship::moveit::conversion_test {

/// As `ros2 topic echo` writes messages: numbers for kinds, points with x, y and z.
inline constexpr const char* kEchoedScene = R"(
robot_state:
  joint_state:
    name: [panda_joint1, panda_joint2, panda_joint3, panda_joint4, panda_joint5, panda_joint6, panda_joint7, panda_finger_joint1]
    position: [0.1, -0.4, 0.0, -2.2, 0.0, 1.8, 0.8, 0.04]
  attached_collision_objects:
  - link_name: panda_link8
    touch_links: [finger_left, panda_leftfinger]
    object:
      header: {frame_id: panda_link8}
      id: cup
      pose: {position: {x: 0.0, y: 0.0, z: 0.1}, orientation: {x: 0, y: 0, z: 0, w: 1}}
      primitives: [{type: 3, dimensions: [0.1, 0.03]}]
      primitive_poses: [{position: {x: 0.0, y: 0.0, z: 0.02}}]
      operation: 0
fixed_frame_transforms:
- header: {frame_id: panda_link0}
  child_frame_id: table
  transform: {translation: {x: 0.5, y: 0.0, z: 0.2}, rotation: {x: 0, y: 0, z: 0, w: 1}}
allowed_collision_matrix:
  entry_names: [panda_link0, shelf, stranger]
  entry_values:
  - enabled: [false, true, true]
  - enabled: [true, false, false]
  - enabled: [true, false, false]
link_padding: [{link_name: panda_link1, padding: 0.01}]
world:
  collision_objects:
  - header: {frame_id: table}
    id: shelf
    pose: {position: {x: 0.0, y: 0.1, z: 0.0}, orientation: {x: 0.0, y: 0.0, z: 0.70710678, w: 0.70710678}}
    primitives:
    - {type: 1, dimensions: [0.4, 0.2, 0.02]}
    - {type: 2, dimensions: [0.05]}
    primitive_poses:
    - {position: {x: 0.3, y: 0.0, z: 0.0}, orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}}
    - {position: {x: 0.0, y: 0.0, z: 0.5}, orientation: {x: 0.0, y: 0.0, z: 0.0, w: 0.0}}
    operation: 0
---
)";

inline constexpr const char* kEchoedRequest = R"(
group_name: panda_arm
allowed_planning_time: 3.5
start_state:
  joint_state: {name: [panda_joint1], position: [0.3]}
  is_diff: true
goal_constraints:
- joint_constraints: []
  position_constraints:
  - header: {frame_id: panda_link0}
    link_name: palm
    target_point_offset: {x: 0.0, y: 0.0, z: 0.0}
    constraint_region:
      primitives: [{type: 2, dimensions: [0.001]}]
      primitive_poses: [{position: {x: 0.4, y: -0.3, z: 0.5}}]
  orientation_constraints:
  - header: {frame_id: panda_link0}
    link_name: palm
    orientation: {x: 1.0, y: 0.0, z: 0.0, w: 0.0}
)";

/// As benchmark sets write them: lists and words.
inline constexpr const char* kListedScene = R"(
world:
  collision_objects:
    - id: box
      header: {frame_id: world}
      primitives: [{type: box, dimensions: [0.1, 0.2, 0.3]}]
      primitive_poses: [{position: [0.5, 0.1, 0.2], orientation: [0, 0, 0, 1]}]
    - id: can
      primitives: [{type: cylinder, dimensions: [0.2, 0.05]}]
      primitive_poses: [{position: [0.5, -0.1, 0.2], orientation: [0, 0, 0, 1]}]
    - id: bowl
      meshes: [{resource: "package://set/bowl.stl", dimensions: [2, 2, 2]}]
      mesh_poses: [{position: [0, 0, 1], orientation: [0, 0, 0, 1]}]
)";

inline std::string listed_request(const std::string& further = "") {
  return R"(
start_state: {joint_state: {name: [panda_joint1, panda_joint2, panda_joint3, panda_joint4, panda_joint5, panda_joint6, panda_joint7], position: [0.1, -0.4, 0, -2.2, 0, 1.8, 0.8]}}
goal_constraints:
  - joint_constraints:
      - {joint_name: panda_joint7, position: 0.7}
      - {joint_name: panda_joint1, position: 0.1}
      - {joint_name: panda_joint2, position: 0.2}
      - {joint_name: panda_joint3, position: 0.3}
      - {joint_name: panda_joint4, position: -0.4}
      - {joint_name: panda_joint5, position: 0.5}
      - {joint_name: panda_joint6, position: 0.6}
)" + further;
}

const models::LoadedRobot& panda();

inline Result<std::vector<Conversion>> convert_all(
    const std::string& scene, const std::string& request,
    const std::optional<Eigen::Isometry3d>& T_task_base = std::nullopt) {
  const test::TemporaryDirectory folder;
  const auto scene_file = folder.path() / "scene.yaml";
  const auto request_file = folder.path() / "request.yaml";
  std::ofstream(scene_file) << scene;
  std::ofstream(request_file) << request;
  return read_problems({.scene = scene.empty() ? "" : scene_file,
                        .request = request_file,
                        .T_task_base = T_task_base,
                        .name = "first"},
                       panda().chain);
}

/// Of a single request.
inline Result<Conversion> convert(
    const std::string& scene, const std::string& request,
    const std::optional<Eigen::Isometry3d>& T_task_base = std::nullopt) {
  auto conversions = convert_all(scene, request, T_task_base);
  if (!conversions)
    return conversions.error();
  EXPECT_EQ(conversions->size(), 1U);
  return conversions->front();
}

inline Eigen::Isometry3d translation(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

inline void expect_pose(const Eigen::Isometry3d& expected, const Eigen::Isometry3d& found) {
  EXPECT_TRUE(expected.isApprox(found, 1e-6)) << expected.matrix() << "\nfound\n" << found.matrix();
}

/// The message of what cannot be converted.
inline std::string refusal(const std::string& scene, const std::string& request) {
  const auto conversion = convert(scene, request);
  return conversion ? "converted" : conversion.error().message;
}

inline std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t place = text.find(what);
  EXPECT_NE(place, std::string::npos) << what;
  return text.replace(place, what.size(), with);
}

}  // namespace kinship::moveit::conversion_test
