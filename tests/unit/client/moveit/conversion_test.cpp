#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/unit/client/moveit/echoed_messages.hpp"

namespace kinship::moveit::conversion_test {
namespace {

TEST(MoveItConversion, StartsWhereTheRequestSaysAndElseWhereTheSceneDoes) {
  const Problem problem = convert(kEchoedScene, kEchoedRequest).value_or_throw().problem;
  Eigen::VectorXd start(7);
  start << 0.3, -0.4, 0, -2.2, 0, 1.8, 0.8;
  EXPECT_EQ(problem.start, start);
  EXPECT_EQ(problem.name, "first");
  EXPECT_EQ(problem.time_limit_s, 3.5);
}

TEST(MoveItConversion, PlacesEachSolidOfAnObjectThroughItsFrames) {
  const Scene scene = convert(kEchoedScene, kEchoedRequest).value_or_throw().problem.scene;
  ASSERT_EQ(scene.objects.size(), 2U);
  const Eigen::Isometry3d T_task_shelf =
      translation(0.5, 0.1, 0.2) *
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(scene.objects[0].name, "shelf/1");
  expect_pose(T_task_shelf * translation(0.3, 0, 0), scene.objects[0].T_task_object);
  EXPECT_EQ(std::get<BoxShape>(scene.objects[0].shape).size, Eigen::Vector3d(0.4, 0.2, 0.02));
  EXPECT_EQ(scene.objects[1].name, "shelf/2");
  expect_pose(T_task_shelf * translation(0, 0, 0.5), scene.objects[1].T_task_object);
}

TEST(MoveItConversion, TheGoalIsThatOfTheTransferFrameWhicheverLinkOfTheHandIsMeant) {
  const Problem problem = convert(kEchoedScene, kEchoedRequest).value_or_throw().problem;
  const kinematics::Chain& chain = panda().chain;
  Eigen::Isometry3d T_base_palm =
      translation(0.4, -0.3, 0.5) * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
  // The palm hangs at the tip: the same for every configuration.
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(7, -0.5);
  const auto links = kinematics::link_poses(chain, q);
  const Eigen::Isometry3d T_palm_transfer =
      links[static_cast<std::size_t>(chain.find_link("palm"))].inverse() *
      kinematics::T_base_transfer(chain, q);
  ASSERT_TRUE(problem.T_task_goal);
  expect_pose(T_base_palm * T_palm_transfer, *problem.T_task_goal);
}

TEST(MoveItConversion, WhatIsHeldHangsAtItsLink) {
  const Conversion conversion = convert(kEchoedScene, kEchoedRequest).value_or_throw();
  ASSERT_EQ(conversion.problem.attached.size(), 1U);
  const AttachedObject& cup = conversion.problem.attached.front();
  EXPECT_EQ(cup.link, "panda_link8");
  EXPECT_EQ(std::get<CylinderShape>(cup.shape).radius_m, 0.03);
  EXPECT_EQ(std::get<CylinderShape>(cup.shape).length_m, 0.1);
  expect_pose(translation(0, 0, 0.12), cup.T_link_object);
  EXPECT_EQ(cup.touch_links, std::vector<std::string>{"finger_left"});
}

TEST(MoveItConversion, AllowedPairsNameEachPartAndOnlyWhatIsThere) {
  using Pairs = std::vector<std::pair<std::string, std::string>>;
  EXPECT_EQ(convert(kEchoedScene, kEchoedRequest).value_or_throw().problem.allowed_collisions,
            (Pairs{{"panda_link0", "shelf/1"}, {"panda_link0", "shelf/2"}}));
}

TEST(MoveItConversion, TellsWhatItLeftOut) {
  const std::string finger =
      "start of joint 'panda_finger_joint1', 0.04: not of the chain; --hold says where it stands";
  const auto left_out = convert(kEchoedScene, kEchoedRequest).value_or_throw().left_out;
  EXPECT_EQ(left_out,
            (std::vector<std::string>{
                finger, "'panda_leftfinger' may touch 'cup', but the robot has no such link",
                "padding and scale of links", "tolerances of the goal: a problem's goal is exact",
                "group_name 'panda_arm': the robot's chain says which joints move"}));
}

TEST(MoveItConversion, ReadsBenchmarkSets) {
  const Conversion conversion = convert(kListedScene, listed_request()).value_or_throw();
  const Problem& problem = conversion.problem;
  ASSERT_EQ(problem.scene.objects.size(), 2U);
  expect_pose(translation(0.5, -0.1, 0.2), problem.scene.objects[1].T_task_object);
  EXPECT_EQ(std::get<CylinderShape>(problem.scene.objects[1].shape).length_m, 0.2);
  ASSERT_EQ(problem.scene.meshes.size(), 1U);
  EXPECT_EQ(problem.scene.meshes[0].mesh.file, "package://set/bowl.stl");
  EXPECT_EQ(problem.scene.meshes[0].mesh.scale, Eigen::Vector3d(2, 2, 2));
  Eigen::VectorXd goal(7);
  goal << 0.1, 0.2, 0.3, -0.4, 0.5, 0.6, 0.7;
  ASSERT_EQ(problem.goal_configurations.cols(), 1);
  EXPECT_EQ(problem.goal_configurations.col(0), goal);
  EXPECT_TRUE(conversion.meshes.empty());
}

TEST(MoveItConversion, APlacementMovesWhatStandsInTheWorld) {
  const Eigen::Isometry3d T_task_base = translation(0, 0, 0.6);
  const Problem problem =
      convert(kListedScene, listed_request(), T_task_base).value_or_throw().problem;
  expect_pose(T_task_base, *problem.T_task_base);
  expect_pose(translation(0.5, 0.1, 0.8), problem.scene.objects[0].T_task_object);
}

TEST(MoveItConversion, TrianglesBecomeAFile) {
  const Conversion conversion = convert(R"(
world:
  collision_objects:
  - id: parts/wedge
    meshes:
    - vertices: [{x: 0, y: 0, z: 0}, {x: 1, y: 0, z: 0}, {x: 0, y: 0.1, z: 0}]
      triangles: [{vertex_indices: [0, 1, 2]}]
    mesh_poses: [{}]
)",
                                        listed_request())
                                    .value_or_throw();
  ASSERT_EQ(conversion.meshes.size(), 1U);
  EXPECT_EQ(conversion.meshes[0].name, "parts_wedge.obj");
  EXPECT_EQ(conversion.meshes[0].obj, "v 0 0 0\nv 1 0 0\nv 0 0.10000000000000001 0\nf 1 2 3\n");
  ASSERT_EQ(conversion.problem.scene.meshes.size(), 1U);
  EXPECT_EQ(conversion.problem.scene.meshes[0].name, "parts/wedge");
  EXPECT_EQ(conversion.problem.scene.meshes[0].mesh.file, "parts_wedge.obj");
}

std::string kept_orientation(const std::string& tolerances) {
  return listed_request(R"(
path_constraints:
  orientation_constraints:
  - header: {frame_id: panda_link0}
    link_name: panda_link8
    orientation: [1, 0, 0, 0]
)" + tolerances);
}

std::string tolerances(double x, double y, double z) {
  return "    absolute_x_axis_tolerance: " + std::to_string(x) +
         "\n    absolute_y_axis_tolerance: " + std::to_string(y) +
         "\n    absolute_z_axis_tolerance: " + std::to_string(z) + "\n";
}

TEST(MoveItConversion, AnOrientationToKeepBecomesARegion) {
  const Conversion conversion =
      convert("", kept_orientation(tolerances(0.125, 0.25, 0.5))).value_or_throw();
  const Problem& problem = conversion.problem;
  ASSERT_TRUE(problem.constraint);
  constexpr double kNoBound = std::numeric_limits<double>::infinity();
  Eigen::Vector<double, 6> upper;
  const double smaller = problem.constraint->bounds(1, 3) / 0.125;
  EXPECT_GT(smaller, 0.4);
  EXPECT_LT(smaller, 1);
  upper << kNoBound, kNoBound, kNoBound, smaller * Eigen::Vector3d(0.125, 0.25, 0.5);
  EXPECT_TRUE(problem.constraint->bounds.row(1).tail<3>().transpose().isApprox(upper.tail<3>()));
  EXPECT_EQ(problem.constraint->bounds.row(1).head<3>().transpose(), upper.head<3>());
  EXPECT_EQ(problem.constraint->bounds.row(0), -problem.constraint->bounds.row(1));
  expect_pose(panda().chain.T_tip_transfer(), problem.constraint->T_region_end);
  EXPECT_TRUE(problem.constraint->T_task_region.linear().isApprox(
      Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix(), 1e-12));
  const std::string& told = conversion.left_out.back();
  EXPECT_EQ(told.find("orientation to be kept: its turns have another order, so that its "
                      "tolerances become 0."),
            0U)
      << told;
}

/// Tolerances that MoveIt's angles would need for a rotation, R = Rx(a) Ry(b) Rz(c).
Eigen::Vector3d angles_xyz(const Eigen::Matrix3d& R) {
  return {std::atan2(-R(1, 2), R(2, 2)), std::asin(R(0, 2)), std::atan2(-R(0, 1), R(0, 0))};
}

TEST(MoveItConversion, WhateverARegionAllowsBesideAFreeTurnTheMessageAllows) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> within(-1, 1);
  const auto turn = [](double angle, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  };
  for (const Eigen::Index free : {0, 2}) {
    Eigen::Vector3d asked(0.3, 0.2, 0.25);
    asked[free] = 6.3;
    const auto problem = convert("", kept_orientation(tolerances(asked.x(), asked.y(), asked.z())))
                             .value_or_throw()
                             .problem;
    Eigen::Vector3d bounds = problem.constraint->bounds.row(1).tail<3>();
    EXPECT_TRUE(std::isinf(bounds[free]));
    EXPECT_GT(bounds[1], 0.14) << "as wide as can be";
    bounds[free] = std::numbers::pi;
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector3d drawn =
          bounds.cwiseProduct(Eigen::Vector3d::NullaryExpr([&] { return within(generator); }));
      const Eigen::Vector3d angles = angles_xyz(turn(drawn.z(), Eigen::Vector3d::UnitZ()) *
                                                turn(drawn.y(), Eigen::Vector3d::UnitY()) *
                                                turn(drawn.x(), Eigen::Vector3d::UnitX()));
      ASSERT_TRUE((angles.cwiseAbs().array() <= asked.array() + 1e-12).all())
          << drawn.transpose() << " is " << angles.transpose();
    }
  }
}

TEST(MoveItConversion, AnOrientationThatBoundsNoTiltIsRefused) {
  for (const std::string& text : {tolerances(0.1, 6.3, 0.1), tolerances(0.1, 6.3, 6.3)})
    EXPECT_NE(refusal("", kept_orientation(text)).find("bound no tilt"), std::string::npos);
  EXPECT_FALSE(
      convert("", kept_orientation(tolerances(6.3, 6.3, 6.3))).value_or_throw().problem.constraint);
  EXPECT_NE(refusal("", kept_orientation(tolerances(0.1, -0.1, 0.1))).find("is below 0"),
            std::string::npos);
}

TEST(MoveItConversion, EachDocumentOfAnEchoedTopicIsAProblem) {
  const std::string requests = std::string(kEchoedRequest) + "---\n" +
                               replaced(kEchoedRequest, "position: [0.3]", "position: [0.6]") +
                               "---\n";
  const auto of_one_scene = convert_all(kEchoedScene, requests).value_or_throw();
  ASSERT_EQ(of_one_scene.size(), 2U);
  EXPECT_EQ(of_one_scene[0].problem.name, "first-1");
  EXPECT_EQ(of_one_scene[1].problem.name, "first-2");
  EXPECT_EQ(of_one_scene[1].problem.start[0], 0.6);
  EXPECT_EQ(of_one_scene[1].problem.scene.objects.size(), 2U);

  const std::string scenes = std::string(kListedScene) + "---\n" + kEchoedScene;
  const auto of_two = convert_all(scenes, listed_request() + "---\n" + listed_request());
  ASSERT_TRUE(of_two) << of_two.error().message;
  EXPECT_EQ(of_two->at(0).problem.scene.meshes.size(), 1U);
  EXPECT_EQ(of_two->at(1).problem.scene.meshes.size(), 0U);

  EXPECT_NE(refusal(scenes, kEchoedRequest).find("holds 2 scenes for 1 requests"),
            std::string::npos);
  EXPECT_NE(refusal("", "---\n").find("holds no request"), std::string::npos);
}

TEST(MoveItConversion, TakesTheBytesOfAnEchoedOperation) {
  const auto with = [](const std::string& operation) {
    return replaced(kListedScene, "- id: can", "- operation: " + operation + "\n      id: can");
  };
  for (const std::string addition : {"\"\\0\"", "!!binary AA==", "0", "add"})
    EXPECT_EQ(refusal(with(addition), listed_request()), "converted") << addition;
  for (const std::string removal : {"\"\\x01\"", "!!binary AQ==", "1", "remove"})
    EXPECT_NE(refusal(with(removal), listed_request()).find("'1, remove' is a change to another"),
              std::string::npos)
        << removal;
}

TEST(MoveItConversion, TheMatrixCountsBeforeDefaultsAndBothDefaultsAreAsked) {
  const auto with = [](const std::string& matrix) {
    return convert(std::string(kListedScene) + matrix, listed_request())
        .value_or_throw()
        .problem.allowed_collisions;
  };
  const std::string forbidden =
      "allowed_collision_matrix:\n  entry_names: [box, panda_link1]\n"
      "  entry_values: [{enabled: [false, false]}, {enabled: [false, false]}]\n";
  const auto pairs = with(forbidden +
                          "  default_entry_names: [box, can]\n"
                          "  default_entry_values: [true, false]\n");
  const auto allows = [&](const std::string& a, const std::string& b) {
    return std::ranges::count(pairs, std::pair(a, b)) + std::ranges::count(pairs, std::pair(b, a));
  };
  EXPECT_EQ(allows("box", "panda_link1"), 0) << "the matrix says no";
  EXPECT_EQ(allows("box", "panda_link2"), 1) << "by default";
  EXPECT_EQ(allows("box", "can"), 0) << "not by the other's default";
  EXPECT_EQ(allows("can", "panda_link2"), 0);
}

TEST(MoveItConversion, AStartThatIsNoChangeHoldsWhatItSays) {
  const std::string whole = listed_request("");
  const std::string said = replaced(whole, "start_state: {", "start_state: {is_diff: false, ");
  EXPECT_EQ(convert(kEchoedScene, whole).value_or_throw().problem.attached.size(), 1U);
  const Conversion conversion = convert(kEchoedScene, said).value_or_throw();
  EXPECT_TRUE(conversion.problem.attached.empty());
  EXPECT_TRUE(std::ranges::any_of(conversion.left_out, [](const std::string& what) {
    return what.starts_with("'cup', attached in the scene: ");
  }));
}

TEST(MoveItConversion, NamesWhatAProblemDoesNotAskFor) {
  const auto left_out =
      convert("", replaced(listed_request(R"(
workspace_parameters: {min_corner: {x: -1, y: -1, z: 0}, max_corner: {x: 1, y: 1, z: 1}}
pipeline_id: ompl
planner_id: RRTConnect
max_velocity_scaling_factor: 0.1
)"),
                           "- {joint_name: panda_joint7, position: 0.7}",
                           "- {joint_name: panda_joint7, position: 0.7}\n"
                           "      - {joint_name: panda_finger_joint1, position: 0.02}"))
          .value_or_throw()
          .left_out;
  for (const std::string what :
       {"goal of joint 'panda_finger_joint1', 0.02: not of the chain",
        "pipeline_id 'ompl': kinship-plan --planner says which planner",
        "planner_id 'RRTConnect': kinship-plan --planner says which planner",
        "workspace_parameters: it bounds a base that moves, not the arm",
        "max_velocity_scaling_factor: a path has no times"})
    EXPECT_EQ(std::ranges::count(left_out, what), 1) << what;
}

TEST(MoveItConversion, ReadsWhatAServiceAnsweredAndAnActionWasAsked) {
  std::string scene = "scene:\n", request = "request:\n";
  std::istringstream lines(kListedScene), request_lines(listed_request());
  for (std::string line; std::getline(lines, line);)
    scene += "  " + line + "\n";
  for (std::string line; std::getline(request_lines, line);)
    request += "  " + line + "\n";
  EXPECT_EQ(convert(scene, request).value_or_throw().problem.scene.objects.size(), 2U);
}

TEST(MoveItConversion, RefusesWhatMustNotVanish) {
  EXPECT_NE(refusal(replaced(kListedScene, "type: box", "type: cone"), listed_request())
                .find("scene.yaml' line 6, world.collision_objects[0].primitives[0].type: 'cone'"),
            std::string::npos);
  EXPECT_NE(
      refusal(std::string(kListedScene) + "  octomap: {octomap: {data: [1]}}\n", listed_request())
          .find("world.octomap.octomap.data: an octomap cannot be taken"),
      std::string::npos);
  EXPECT_NE(refusal(replaced(kListedScene, "- id: can", "- operation: 1\n      id: can"),
                    listed_request())
                .find("'1, remove' is a change to another scene"),
            std::string::npos);
  EXPECT_NE(refusal(std::string(kListedScene) + "is_diff: true\n", listed_request())
                .find("is_diff: a change to another scene"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(kListedScene, "frame_id: world", "frame_id: camera"), listed_request())
                .find("frame 'camera' is not known"),
            std::string::npos);
  EXPECT_NE(refusal("", listed_request("path_constraints: {position_constraints: [{}]}"))
                .find("path_constraints.position_constraints: a problem cannot say this"),
            std::string::npos);
}

TEST(MoveItConversion, RefusesWhatIsNotThere) {
  EXPECT_NE(refusal("", "goal_constraints: []").find("nothing is said of joint 'panda_joint1'"),
            std::string::npos);
  EXPECT_NE(refusal("", replaced(listed_request(), "panda_joint6, position: 0.6",
                                 "panda_joint1, position: 0.6"))
                .find("goal_constraints[0].joint_constraints: nothing is said of joint "
                      "'panda_joint6'"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(kListedScene, "[0.1, 0.2, 0.3]", "[0.1, 0.2]"), listed_request())
                .find("dimensions: 2 numbers instead of 3"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(kListedScene, "[0.1, 0.2, 0.3]", "'...'"), listed_request())
                .find("--full-length"),
            std::string::npos);
  EXPECT_NE(refusal(std::string(kListedScene) + "    - '...'\n", listed_request())
                .find("world.collision_objects: the list was cut"),
            std::string::npos);
  EXPECT_NE(refusal("a: [", listed_request()).find("is no YAML"), std::string::npos);
  EXPECT_NE(refusal(replaced(kEchoedScene, "object:\n      header: {frame_id: panda_link8}",
                             "object:\n      header: {frame_id: nowhere}"),
                    kEchoedRequest)
                .find("frame 'nowhere' is not known"),
            std::string::npos);
}

TEST(MoveItConversion, AVirtualJointPlacesTheRobotInItsFrame) {
  const std::string moved = replaced(
      replaced(kListedScene, "frame_id: world", "frame_id: odom"), "world:",
      "robot_state:\n  multi_dof_joint_state:\n    header: {frame_id: odom}\n"
      "    joint_names: [virtual_joint]\n    transforms: [{translation: {x: 1, y: 0, z: 0}}]\n"
      "world:");
  const Problem problem = convert(moved, listed_request()).value_or_throw().problem;
  expect_pose(translation(1, 0, 0), *problem.T_task_base);
  expect_pose(translation(0.5, 0.1, 0.2), problem.scene.objects[0].T_task_object);
  // Wherever the station has it, the box stands to the robot as it did.
  const Problem placed =
      convert(moved, listed_request(), translation(0, 0, 0.6)).value_or_throw().problem;
  expect_pose(translation(-0.5, 0.1, 0.8), placed.scene.objects[0].T_task_object);
  EXPECT_NE(refusal(replaced(moved, "transforms: [", "transforms: [{}, "), listed_request())
                .find("2 joints of several degrees of freedom"),
            std::string::npos);
}

}  // namespace
}  // namespace kinship::moveit::conversion_test
