// Documents that are no scene or request, and scenes in RViz's text form.
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/client/moveit/echoed_messages.hpp"

namespace kinship::moveit::scene_form_test {
namespace {

using namespace conversion_test;

/// What is said of a scene beside a request that is right.
std::string said_of(const std::string& scene) { return refusal(scene, listed_request()); }

void expect_refused(const std::string& scene, const std::string& why) {
  const std::string said = said_of(scene);
  EXPECT_NE(said.find(why), std::string::npos) << scene << "\nsaid\n" << said;
  EXPECT_NE(said.find("scene.yaml' line "), std::string::npos) << said;
}

TEST(MoveItSceneForm, ASceneSaysWhatIsAroundTheRobotOrThatNothingIs) {
  EXPECT_TRUE(convert("world: {collision_objects: []}", listed_request())
                  .value_or_throw()
                  .problem.scene.objects.empty());
  const std::string missing = "world.collision_objects: is missing; an empty scene says";
  for (const std::string scene : {"name: s\n", "world: {}\n", "world:\n", "name: s\nworld: ~\n",
                                  "world: {collision_objects: }\n", "scene: {name: s}\n"})
    expect_refused(scene, missing);
}

TEST(MoveItSceneForm, WhatIsNoMapIsNoScene) {
  for (const std::string scene : {"<html><body>404 Not Found</body></html>\n", "404\n",
                                  "- world: {collision_objects: []}\n", "scene: [1]\n", "[]\n"})
    expect_refused(scene, "is no PlanningScene: a map of its members is expected");
  expect_refused("world: [{collision_objects: []}]", "world: is no PlanningSceneWorld");
  expect_refused("world: {collision_objects: {id: box}}", "world.collision_objects: is no list");
  expect_refused("world: {collision_objects: [box]}",
                 "world.collision_objects[0]: is no CollisionObject");
  EXPECT_NE(refusal("", "<html/>").find("is no MotionPlanRequest"), std::string::npos);
  EXPECT_NE(refusal("", "[1]").find("is no MotionPlanRequest"), std::string::npos);
}

TEST(MoveItSceneForm, AMemberThatNoMessageHasIsRefusedWithTheOneThatMayBeMeant) {
  const auto with = [](const std::string& member, const std::string& misspelt) {
    return replaced(kListedScene, member + ":", misspelt + ":");
  };
  expect_refused(with("collision_objects", "colision_objects"),
                 "line 3, world.colision_objects: 'colision_objects' is no member of "
                 "PlanningSceneWorld (did you mean 'collision_objects'?)");
  expect_refused(with("world", "World"), "is no member of PlanningScene (did you mean 'world'?)");
  expect_refused(with("dimensions", "dimension"),
                 "world.collision_objects[0].primitives[0].dimension: 'dimension' is no member of "
                 "SolidPrimitive (did you mean 'dimensions'?)");
  expect_refused(with("primitive_poses", "primitives_poses"), "did you mean 'primitive_poses'?");
  expect_refused(with("position", "postion"), "did you mean 'position'?");
  expect_refused(with("orientation", "orientaton"), "did you mean 'orientation'?");
  expect_refused(with("meshes", "mesh"), "'mesh' is no member of CollisionObject");
  expect_refused(with("frame_id", "frame"), "'frame' is no member of Header");
  const std::string echoed = replaced(kEchoedScene, "z: 0.2}", "Z: 0.2}");
  EXPECT_NE(refusal(echoed, kEchoedRequest).find("'Z' is no member of Vector3"), std::string::npos);
  for (const std::string wrong :
       {"path_constraint: {}", "goal_constraint: []", "trajectory_constraints: {constraint: []}"})
    EXPECT_NE(refusal("", listed_request(wrong)).find("did you mean"), std::string::npos) << wrong;
}

TEST(MoveItSceneForm, AMemberThatIsThereTwiceIsRefused) {
  expect_refused(std::string(kListedScene) + "world: {collision_objects: []}\n",
                 "world: 'world' is there twice");
}

TEST(MoveItSceneForm, WhatStandsBesideAWrappedSceneDoesNotVanish) {
  expect_refused("scene: {world: {collision_objects: []}}\nworld: {collision_objects: []}\n",
                 "'world' is not known beside 'scene'");
  const std::string goal =
      "planning_options: {planning_scene_diff: {world: {collision_objects: "
      "[{id: box}]}}}\nrequest: {goal_constraints: []}\n";
  EXPECT_NE(refusal("", goal).find("collision_objects: a change to the scene"), std::string::npos);
}

TEST(MoveItSceneForm, MembersThatTheMessagesHaveAreTakenAlsoWhereNothingIsDoneWithThem) {
  const std::string scene = R"(
name: s
robot_model_name: panda
is_diff: false
object_colors: [{id: box, color: {r: 1, g: 0, b: 0, a: 1}}]
link_padding: [{link_name: panda_link1, padding: 0}]
link_scale: [{link_name: panda_link1, scale: 1}]
fixed_frame_transforms: []
robot_state:
  joint_state: {header: {seq: 1, stamp: {sec: 0, nanosec: 0}, frame_id: ''}, name: [], position: [], velocity: [], effort: []}
  multi_dof_joint_state: {header: {frame_id: ''}, joint_names: [], transforms: [], twist: [], wrench: []}
  attached_collision_objects:
  - {link_name: panda_link8, touch_links: [], detach_posture: {header: {}, joint_names: [], points: []}, weight: 0.1,
     object: {header: {frame_id: panda_link8}, id: cup, primitives: [{type: 2, dimensions: [0.1], polygon: {points: []}}],
              primitive_poses: [{position: {x: 0, y: 0, z: 0.1}, orientation: {x: 0, y: 0, z: 0, w: 1}}]}}
  is_diff: false
allowed_collision_matrix: {entry_names: [], entry_values: [], default_entry_names: [], default_entry_values: []}
world:
  octomap: {header: {frame_id: ''}, origin: {position: {x: 0, y: 0, z: 0}}, octomap: {header: {}, binary: false, id: '', resolution: 0.0, data: []}}
  collision_objects:
  - {header: {frame_id: world}, id: box, type: {key: '', db: ''}, primitives: [{type: 1, dimensions: [1, 1, 1]}],
     primitive_poses: [{position: {x: 2, y: 0, z: 0}}], meshes: [], mesh_poses: [], planes: [], plane_poses: [],
     subframe_names: [top], subframe_poses: [{position: {x: 0, y: 0, z: 1}}], operation: 0}
)";
  const std::string request = listed_request(R"(
workspace_parameters: {header: {frame_id: ''}, min_corner: {x: 0, y: 0, z: 0}, max_corner: {x: 0, y: 0, z: 0}}
path_constraints: {name: '', joint_constraints: [], position_constraints: [], orientation_constraints: [], visibility_constraints: []}
trajectory_constraints: {constraints: []}
reference_trajectories: []
pipeline_id: ''
planner_id: ''
group_name: arm
num_planning_attempts: 1
allowed_planning_time: 5.0
max_velocity_scaling_factor: 0.0
max_acceleration_scaling_factor: 0.0
cartesian_speed_end_effector_link: ''
cartesian_speed_limited_link: ''
max_cartesian_speed: 0.0
)");
  EXPECT_EQ(refusal(scene, request), "converted");
}

TEST(MoveItSceneForm, AConstraintOfSightHasTheMembersThatMoveItHas) {
  const auto with = [](const std::string& member) {
    return refusal("", listed_request("trajectory_constraints: {constraints: "
                                      "[{visibility_constraints: [{" +
                                      member + ": 0.1}]}]}"));
  };
  EXPECT_EQ(with("max_view_angle").find("is no member"), std::string::npos);
  EXPECT_NE(with("min_view_angle").find("is no member of VisibilityConstraint"), std::string::npos);
}

/// A scene as newer versions export it: an object at (1, 0, 0) turned by half a turn about z.
const std::string kExported = R"((noname)++
* my box
1 0 0
0 0 1 0
2
box
0.1 0.2 0.3
0.5 0 0.3
0 0 0 1
0 0 0 0
cylinder
0.05 0.4
0 0 0.2
0 0 0 1
1 0 0 1
1
top
0 0 0.15
0 0 0 1
* ball
0 0 0
0 0 0 1
1
sphere
0.07
0.1 0.2 0.3
0 0 0 1
0 0 0 0
0
.
)";

Scene scene_of(const std::string& text) {
  return convert(text, listed_request()).value_or_throw().problem.scene;
}

TEST(MoveItSceneText, ShapesStandWhereObjectAndShapePutThem) {
  const Scene scene = scene_of(kExported);
  ASSERT_EQ(scene.objects.size(), 3U);
  EXPECT_EQ(scene.objects[0].name, "my box/1");
  EXPECT_EQ(std::get<BoxShape>(scene.objects[0].shape).size, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_TRUE(
      scene.objects[0].T_task_object.translation().isApprox(Eigen::Vector3d(0.5, 0, 0.3), 1e-9));
  const auto& cylinder = std::get<CylinderShape>(scene.objects[1].shape);
  EXPECT_EQ(cylinder.radius_m, 0.05);
  EXPECT_EQ(cylinder.length_m, 0.4);
  EXPECT_EQ(std::get<SphereShape>(scene.objects[2].shape).radius_m, 0.07);
  expect_pose(translation(0.1, 0.2, 0.3), scene.objects[2].T_task_object);
}

TEST(MoveItSceneText, OlderFilesHaveNeitherPoseNorSubframes) {
  const Scene scene = scene_of(
      "old\n* wall\n2\nbox\n1 2 3\n0 0 1\n0 0 0 1\n0 0 0 0\nsphere\n0.1\n0 1 0\n0 0 0 1\n"
      "0 0 0 0\n* b\n1\nsphere\n0.2\n1 0 0\n0 0 0 1\n0 0 0 0\n.\n");
  ASSERT_EQ(scene.objects.size(), 3U);
  expect_pose(translation(0, 0, 1), scene.objects[0].T_task_object);
  EXPECT_EQ(scene.objects[2].name, "b");
  EXPECT_TRUE(scene_of("nothing\n.\n").objects.empty());
}

TEST(MoveItSceneText, MeshesBecomeFiles) {
  const Conversion made =
      convert(
          "m\n* hull\n1 2 3\n0 0 0 1\n1\nmesh\n3 1\n0 0 0\n1 0 0\n0 1 0\n0 1 2\n0 0 0\n0 0 0 1\n"
          "0 0 0 0\n0\n.\n",
          listed_request())
          .value_or_throw();
  ASSERT_EQ(made.problem.scene.meshes.size(), 1U);
  expect_pose(translation(1, 2, 3), made.problem.scene.meshes[0].T_task_mesh);
  ASSERT_EQ(made.meshes.size(), 1U);
  EXPECT_EQ(made.meshes[0].obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
}

TEST(MoveItSceneText, WhatDoesNotFitIsRefusedWithItsLine) {
  const auto with = [](const std::string& what, const std::string& other) {
    return said_of(replaced(kExported, what, other));
  };
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {with("box\n0.1", "bux\n0.1"),
       "line 6: box, sphere, cylinder or mesh is expected, not 'bux'"},
      {with("cylinder", "cone"), "line 11: a problem cannot say this shape"},
      {with("0.1 0.2 0.3\n", "0.1 0.2\n"), "line 11: a finite number is expected, not 'cylinder'"},
      {with("0.05 0.4", "0,05 0.4"), "line 12: a finite number is expected, not '0,05'"},
      {with("0.05 0.4", "-0.05 0.4"), "line 12: a size above 0 is expected, not '-0.05'"},
      {with("0 0 1 0\n", "0 0 0 0\n"), "line 4: is no rotation"},
      {with("* ball", "* my box"), "line 20: an object that is there already: 'my box'"},
      {with("* ball", "ball"), "line 20: '*' or '.' is expected, not 'ball'"},
      {with("\n.\n", "\n"),
       "line 30: '*' or '.' is expected, and the file ends here: is it cut off?"},
      {with("\n.\n", "\n.\n* b\n"), "line 31: nothing is expected behind the '.'"},
      {with("1\ntop", "2\ntop"), "line 20: a finite number is expected, not 'ball'"}};
  for (const auto& [said, why] : wrong)
    EXPECT_NE(said.find("scene.yaml' " + why), std::string::npos) << why << "\nsaid\n" << said;
}

}  // namespace
}  // namespace kinship::moveit::scene_form_test
