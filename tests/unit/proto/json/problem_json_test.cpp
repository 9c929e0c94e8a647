#include "proto/json/problem_json.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace kinship::json::problem_json_test {
namespace {

constexpr const char* kProblem = R"({"name": "shelf 7", "T_task_base": [0, 0, 0.5, 0, 0, 0, 1],
  "start": [0.1, 0.2], "goal": {"configurations": [[1, 2], [3, 4]]},
  "scene": {"boxes": [{"name": "table", "pose": [1, 0, 0, 0, 0, 0, 1], "size": [1, 2, 0.1]}],
            "cylinders": [{"name": "post", "pose": [0, 1, 0, 0, 0, 0, 1], "radius": 0.1, "length": 2}],
            "spheres": [{"name": "ball", "center": [0, 0, 1], "radius": 0.2}], "meshes": []},
  "attached": [{"name": "crate", "link": "hand", "shape": {"box": [0.1, 0.2, 0.3]},
                "T_link_object": [0, 0, 0.1, 0, 0, 0, 1], "touch_links": ["finger"]}],
  "allowed_collisions": [["crate", "table"]], "constraint": null, "time_limit_s": 5, "seed": 42})";

std::string changed(std::string_view from, std::string_view to) {
  std::string text = kProblem;
  const std::size_t position = text.find(from);
  EXPECT_NE(position, std::string::npos) << from;
  return text.replace(position, from.size(), to);
}

std::string message_of(const std::string& text) {
  const auto result = problem_from_json(text);
  return result ? "accepted" : result.error().message;
}

TEST(ProblemJson, OnlyNameStartAndGoalAreRequired) {
  const auto problem =
      problem_from_json(R"({"name": "n", "start": [0], "goal": {"pose": [1, 0, 0, 0, 0, 0, 1]}})");
  ASSERT_TRUE(problem) << problem.error().message;
  EXPECT_EQ(problem->T_task_goal->translation(), Eigen::Vector3d(1, 0, 0));
  EXPECT_FALSE(problem->T_task_base);
  EXPECT_EQ(problem->time_limit_s, 10);
  EXPECT_TRUE(problem->scene.objects.empty());
}

TEST(ProblemJson, AStartIsJointsOrAPoseAndNothingElse) {
  const auto with = [](const std::string& start) {
    return R"({"name": "n", "start": )" + start + R"(, "goal": {"configurations": [[1, 2]]}})";
  };
  const auto problem = problem_from_json(with(R"({"pose": [1, 2, 3, 0, 0, 0, 1]})"));
  ASSERT_TRUE(problem) << problem.error().message;
  EXPECT_EQ(problem->T_task_start->translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(problem->start.size(), 0);
  const auto again = problem_from_json(to_json(*problem));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_TRUE(again->T_task_start->isApprox(*problem->T_task_start));
  EXPECT_FALSE(problem_from_json(with("[1, 2]"))->T_task_start);
  EXPECT_EQ(message_of(with("[]")), "start: is empty");
  EXPECT_EQ(message_of(with("{}")), "start.pose: is missing");
  EXPECT_EQ(message_of(with(R"({"pose": [1]})")).find("start.pose: "), 0U);
  EXPECT_NE(message_of(with(R"({"pose": [0,0,0,0,0,0,1], "link": "hand"})")).find("link"),
            std::string::npos);
}

TEST(ProblemJson, AMissingPlacementIsWrittenAsMissing) {
  Problem problem;
  problem.start = problem.goal_configurations = Eigen::VectorXd::Zero(1);
  const std::string text = to_json(problem);
  EXPECT_NE(text.find(R"("T_task_base":null)"), std::string::npos) << text;
  problem.T_task_base = Eigen::Isometry3d::Identity();
  EXPECT_TRUE(problem_from_json(to_json(problem))->T_task_base);
}

constexpr const char* kMeshes =
    R"("meshes": [{"name": "m", "file": "m.stl", "pose": [0,0,1,0,0,0,1], "scale": [1, -2, 1]}])";

TEST(ProblemJson, MeshesAreReadAndWrittenAsNamesOfFiles) {
  std::string text = changed("\"meshes\": []", kMeshes);
  const std::string box = R"({"box": [0.1, 0.2, 0.3]})";
  text.replace(text.find(box), box.size(), R"({"mesh": "package://tools/crate.obj"})");
  const auto first = problem_from_json(text);
  ASSERT_TRUE(first) << first.error().message;
  const auto again = problem_from_json(to_json(*first));
  ASSERT_TRUE(again) << again.error().message;
  for (const Problem& problem : {*first, *again}) {
    ASSERT_EQ(problem.scene.meshes.size(), 1U);
    EXPECT_EQ(problem.scene.meshes[0].name, "m");
    EXPECT_EQ(problem.scene.meshes[0].mesh.file, "m.stl");
    EXPECT_EQ(problem.scene.meshes[0].mesh.scale, Eigen::Vector3d(1, -2, 1));
    EXPECT_EQ(problem.scene.meshes[0].T_task_mesh.translation(), Eigen::Vector3d(0, 0, 1));
    EXPECT_EQ(problem.scene.meshes[0].mesh.triangles, nullptr);
    ASSERT_TRUE(problem.attached.at(0).mesh);
    EXPECT_EQ(problem.attached[0].mesh->file, "package://tools/crate.obj");
    EXPECT_EQ(problem.attached[0].mesh->scale, Eigen::Vector3d(1, 1, 1));
  }
}

TEST(ProblemJson, PointCloudsAreReadAndWrittenAsNamesOfFiles) {
  const std::string cloud =
      R"({"name": "c", "file": "c.pcd", "pose": [0, 0, 1, 0, 0, 0, 1], "voxel": 0.05})";
  const auto with = [](const std::string& entry) {
    return changed("\"meshes\": []", "\"clouds\": [" + entry + "]");
  };
  const auto first = problem_from_json(with(cloud));
  ASSERT_TRUE(first) << first.error().message;
  const auto again = problem_from_json(to_json(*first));
  ASSERT_TRUE(again) << again.error().message;
  for (const Problem& problem : {*first, *again}) {
    ASSERT_EQ(problem.scene.clouds.size(), 1U);
    EXPECT_EQ(problem.scene.clouds[0].name, "c");
    EXPECT_EQ(problem.scene.clouds[0].cloud.file, "c.pcd");
    EXPECT_EQ(problem.scene.clouds[0].cloud.voxel_m, 0.05);
    EXPECT_EQ(problem.scene.clouds[0].T_task_cloud.translation(), Eigen::Vector3d(0, 0, 1));
    EXPECT_EQ(problem.scene.clouds[0].cloud.voxels, nullptr);
  }
  std::string flat = cloud;
  flat.replace(flat.find("0.05"), 4, "0.0001");
  EXPECT_EQ(message_of(with(flat)).find("scene.clouds[0].voxel: "), 0U) << message_of(with(flat));
}

TEST(ProblemJson, AMeshThatCannotBeIsRefusedByName) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string meshes = kMeshes;
    meshes.replace(meshes.find(from), from.size(), to);
    return message_of(changed("\"meshes\": []", meshes));
  };
  EXPECT_EQ(with(R"("file": "m.stl", )", ""), "scene.meshes[0].file: is missing");
  EXPECT_EQ(with("m.stl", ""), "scene.meshes[0].file: is empty");
  EXPECT_EQ(with("-2", "0"), "scene.meshes[0].scale[1]: is 0, which makes the mesh flat");
  EXPECT_EQ(with("[1, -2, 1]", "[1]"), "scene.meshes[0].scale: 1 factors, must be 3");
}

std::string constrained(const std::string& bounds, const std::string& T_region_end) {
  return changed("\"constraint\": null",
                 R"("constraint": {"T0_w": [0, 0, 1, 0, 0, 0, 1], "Tw_e": )" + T_region_end +
                     ", \"Bw\": " + bounds + "}");
}

constexpr const char* kHandDown = "[0, 0, 0.1, 1, 0, 0, 0]";
constexpr const char* kLevel =
    "[[null, null], [-0.5, 0.5], [0, null], [-0.1, 0.1], [-0.1, 0.1], [null, null]]";

TEST(ProblemJson, AConstraintIsReadAndWrittenWithNullWhereThereIsNoBound) {
  const auto problem = problem_from_json(constrained(kLevel, kHandDown));
  ASSERT_TRUE(problem) << problem.error().message;
  ASSERT_TRUE(problem->constraint);
  const TaskSpaceRegion& region = *problem->constraint;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::Matrix<double, 2, 6> expected;
  expected << -kInfinity, -0.5, 0, -0.1, -0.1, -kInfinity,  //
      kInfinity, 0.5, kInfinity, 0.1, 0.1, kInfinity;
  EXPECT_EQ(region.bounds, expected);
  EXPECT_EQ(region.T_task_region.translation(), Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(region.T_region_end.linear(), Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix());

  const auto back = problem_from_json(to_json(*problem));
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_TRUE(back->constraint);
  EXPECT_EQ(back->constraint->bounds, expected);
  EXPECT_TRUE(back->constraint->T_region_end.isApprox(region.T_region_end, 1e-12));
}

TEST(ProblemJson, AConstraintThatCannotHoldIsRefusedByName) {
  EXPECT_EQ(message_of(constrained(kLevel, "[0, 0, 0, 0, 0, 0, 0]")),
            "constraint.Tw_e: pose: quaternion (x y z w) has norm 0, must be 1");
  EXPECT_EQ(message_of(constrained("[[0, 0]]", kHandDown)),
            "constraint.Bw: 1 pairs, must be 6: [lower, upper] of x y z roll pitch yaw");
  EXPECT_EQ(
      message_of(constrained("[[0, 0], [0, 0], [0, 0], [0, 0], [0.2, 0.1], [0, 0]]", kHandDown)),
      "constraint: Bw of pitch: lower 0.2 exceeds upper 0.1");
  EXPECT_EQ(
      message_of(constrained("[[0, 0], [0, 0, 0], [0, 0], [0, 0], [0, 0], [0, 0]]", kHandDown)),
      "constraint.Bw[1]: 3 elements exceed 2");
  EXPECT_EQ(message_of(constrained("[[0, 0], [0], [0, 0], [0, 0], [0, 0], [0, 0]]", kHandDown)),
            "constraint.Bw[1]: must be [lower, upper], null for no bound");
  EXPECT_EQ(message_of(changed("\"constraint\": null", "\"constraint\": {}")),
            "constraint.T0_w: is missing");
  EXPECT_EQ(message_of(changed("\"constraint\": null", "\"constraint\": {\"Bv\": []}")),
            "constraint: has an unknown member 'Bv'");
}

TEST(ProblemJson, GoalIsEitherConfigurationsOrPose) {
  EXPECT_EQ(message_of(changed("\"configurations\"", "\"neither\"")),
            "goal: has an unknown member 'neither'");
  EXPECT_EQ(message_of(changed("[[1, 2], [3, 4]]", "null")),
            "goal: must have either configurations or pose");
  EXPECT_EQ(message_of(changed("\"goal\": {", R"("goal": {"pose": [0,0,0,0,0,0,1], )")),
            "goal: must have either configurations or pose");
  EXPECT_EQ(message_of(changed("[[1, 2], [3, 4]]", "[]")), "goal.configurations: is empty");
  EXPECT_EQ(message_of(changed("[[1, 2], [3, 4]]", "[[1, 2, 3]]")),
            "goal.configurations: 3 joints, start has 2");
}

TEST(ProblemJson, SolidsNeedPositiveExtents) {
  EXPECT_EQ(message_of(changed("[1, 2, 0.1]", "[1, 2, 0]")),
            "scene.boxes[0].size[2]: 0 m, must be above 0");
  EXPECT_FALSE(problem_from_json(changed("\"radius\": 0.2", "\"radius\": -0.2")));
  EXPECT_EQ(message_of(changed("[1, 2, 0.1]", "[1, 2]")),
            "scene.boxes[0].size: 2 extents, must be 3");
  EXPECT_EQ(message_of(changed("[1, 2, 0.1]", "[1, 2, 1e4]")),
            "scene.boxes[0].size[2]: 10000 m exceeds 1000 m; these are probably millimetres");
  EXPECT_EQ(message_of(changed(R"({"box": [0.1, 0.2, 0.3]})", R"({"cone": 1})")),
            "attached[0].shape: must be one of box, cylinder, sphere, capsule");
}

TEST(ProblemJson, ObjectsOfOneSceneHaveNamesOfTheirOwn) {
  const std::string document =
      R"({"name": "p", "start": [0], "goal": {"configurations": [[1]]}, "scene": {"spheres": [{"name": "a",
      "center": [1, 0, 0], "radius": 0.1}], "meshes": [{"name": "b", "file": "b.stl",
      "pose": [0, 0, 0, 0, 0, 0, 1]}]}})";
  EXPECT_TRUE(problem_from_json(document));
  std::string repeated = document;
  repeated.replace(repeated.find(R"("b")"), 3, R"("a")");
  EXPECT_EQ(problem_from_json(repeated).error().message,
            "scene: two objects are named 'a': each needs a name of its own");
}

TEST(ProblemJson, ResultWithoutGuidanceWritesNull) {
  ProblemResult result;
  result.name = "shelf 7";
  result.reason = "time limit";
  EXPECT_EQ(
      to_json(result),
      R"({"format":"kinship.result/1","name":"shelf 7","solved":false,"collision_checks":0,"goal_checks":0,)"
      R"("shortcut_checks":0,"projections":0,"proven":false,"path_length":null,"hand_length_m":null,)"
      R"("least_clearance_m":null,"refuted_edges":0,)"
      R"("planning_time_s":0.0,"processor_time_s":0.0,"time_limit_s":0.0,"start":null,)"
      R"("waypoints":null,"guidance":null,)"
      R"("found_by":"nothing","guidance_reason":"","planner":"","reason":"time limit",)"
      R"("not_planned":null})");
}

TEST(ProblemJson, AControlResultTellsTheGuidanceItDidNotUse) {
  ProblemResult result;
  result.distribution_id = Digest{};
  result.sampling_mode = SamplingMode::Control;
  const std::string text = to_json(result);
  EXPECT_NE(
      text.find(
          R"("revision":0,"share":0.0,"sampling_mode":"control","gate_fired":false,)"
          R"("track_share":0.0,"experience_revision":0,"tracks_followed":0,"recall_tries":0,"guide":"none"})"),
      std::string::npos)
      << text;
  EXPECT_EQ(problem_result_from_json(text)->sampling_mode, SamplingMode::Control);
  const std::string broken = std::string(text).replace(text.find("control"), 7, "placebo");
  EXPECT_FALSE(problem_result_from_json(broken));
}

TEST(ProblemJson, AMisspeltMemberIsNotDropped) {
  const auto refused = problem_from_json(
      R"({"name": "a", "start": [0], "goal": {"configurations": [[1]]}, "scene": {"boxs": []}})");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "scene: has an unknown member 'boxs'");
  EXPECT_EQ(problem_from_json(
                R"({"name": "a", "start": [0], "goal": {"configurations": [[1]]}, "atached": []})")
                .error()
                .message,
            "has an unknown member 'atached'");
}

}  // namespace
}  // namespace kinship::json::problem_json_test
