// A robot with all that public URDFs bring (a lift, a gripper with a mimic joint, a mesh in a
// package, an SRDF) is registered, planned for, reported and guided by kinship-plan alone.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "proto/json/problem_json.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/cell.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::brought_robot_test {
namespace {

std::string box_link(const std::string& name, const std::string& center, const std::string& size) {
  return "<link name='" + name + "'><collision><origin xyz='" + center +
         "'/><geometry><box size='" + size + "'/></geometry></collision></link>";
}

std::string joint(const std::string& name, const std::string& type, const std::string& links,
                  const std::string& rest) {
  const std::size_t space = links.find(' ');
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + links.substr(0, space) +
         "'/><child link='" + links.substr(space + 1) + "'/>" + rest + "</joint>";
}

std::string turning(const std::string& at) {
  return "<origin xyz='" + at +
         "'/><axis xyz='0 0 1'/><limit lower='-2' upper='2' effort='1' velocity='1'/>";
}

const std::string kSliding = "<limit lower='0' upper='0.04' effort='1' velocity='1'/>";

/// base -lift- carriage -j1- upper -j2- fore -j3- hand with two fingers, of which one mimics the
/// other; a column that is a mesh in mm; a cable on the base that the hand touches at the start.
std::string lifter_urdf() {
  return "<robot name='lifter'>" + box_link("base", "0 0 -0.1", "0.2 0.2 0.1") +
         "<link name='column'><collision><origin xyz='-0.2 -0.025 0'/><geometry><mesh "
         "filename='package://lifter/meshes/Column.STL' scale='0.001 0.001 0.001'/></geometry>"
         "</collision></link>" +
         box_link("cable", "0.68 0 0.22", "0.05 0.02 0.02") +
         box_link("carriage", "0 0 0", "0.08 0.08 0.08") +
         box_link("upper", "0.15 0 0", "0.3 0.05 0.04") +
         box_link("fore", "0.15 0 0", "0.3 0.05 0.04") +
         box_link("hand", "0.04 0 0", "0.06 0.1 0.04") +
         box_link("left", "0.04 0 0", "0.06 0.01 0.02") +
         box_link("right", "0.04 0 0", "0.06 0.01 0.02") +
         joint("stand", "fixed", "base column", "") + joint("clip", "fixed", "base cable", "") +
         joint("lift", "prismatic", "base carriage",
               "<origin xyz='0 0 0.1'/><axis xyz='0 0 1'/><limit lower='0' upper='0.4' effort='1' "
               "velocity='1'/>") +
         joint("j1", "revolute", "carriage upper", turning("0 0 0.07")) +
         joint("j2", "revolute", "upper fore", turning("0.3 0 0.05")) +
         joint("j3", "revolute", "fore hand", turning("0.32 0 0")) +
         joint("grip", "prismatic", "hand left",
               "<origin xyz='0.04 0.01 0'/><axis xyz='0 1 0'/>" + kSliding) +
         joint("grip_too", "prismatic", "hand right",
               "<origin xyz='0.04 -0.01 0'/><axis xyz='0 -1 0'/><mimic joint='grip'/>" + kSliding) +
         "</robot>";
}

/// From beside the cable to the other side of a post, and up.
Problem past_the_post(int number) {
  Problem problem;
  problem.name = "past-" + std::to_string(number);
  problem.T_task_base = Eigen::Isometry3d::Identity();
  problem.start = Eigen::Vector4d(0, 0, 0, 0);
  problem.goal_configurations = Eigen::Vector4d(0.3, 1.2, 0.2, 0.1 * number);
  problem.scene.objects.push_back({"post", BoxShape{{0.04, 0.04, 0.2}},
                                   Eigen::Isometry3d(Eigen::Translation3d(0.35, 0.35, 0.1))});
  problem.time_limit_s = 600;
  problem.seed = static_cast<std::uint64_t>(number);
  return problem;
}

class BroughtRobot : public testing::Test {
 protected:
  BroughtRobot() {
    std::filesystem::create_directories(directory_ / "lifter/meshes");
    write("lifter/meshes/Column.STL", test::BoxMesh({50, 50, 600}).binary_stl());
    write("lifter.urdf", lifter_urdf());
    write("lifter.srdf",
          "<robot name='lifter'><disable_collisions link1='cable' link2='hand' "
          "reason='Never'/><disable_collisions link1='left' link2='cable'/>"
          "<disable_collisions link1='right' link2='cable'/></robot>");
    std::string lines;
    for (int i = 0; i < 6; ++i)
      lines += json::to_json(past_the_post(i)) + "\n";
    write("problems.jsonl", lines);
  }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_.path() / name, std::ios::binary) << text;
    return directory_.path() / name;
  }

  /// Runs kinship-plan for the lifter; what it writes is left in results_ and messages_.
  int plan(const std::string& more) {
    const std::string folder = directory_.path().string();
    const test::Answer answer = cell_.run(
        "kinship-plan", "--robot " + folder + "/lifter.urdf --tip hand --package lifter=" + folder +
                            "/lifter --problems " + folder + "/problems.jsonl --srdf " + folder +
                            "/lifter.srdf --json " + more);
    messages_ = answer.err;
    results_.clear();
    std::istringstream lines(answer.out);
    for (std::string line; std::getline(lines, line);)
      results_.push_back(json::problem_result_from_json(line).value_or_throw());
    return answer.code;
  }

  int plan_with_server(const std::string& more) {
    return plan("--base base --axes x,y,z,yaw --task past --wait 600 --server 127.0.0.1 " + more +
                " --outbox " + (directory_ / "plan_outbox").string() +
                " --transfer '0.08 0 0 0 0 0 1'");
  }

  const test::TemporaryDirectory directory_;
  test::Cell cell_{{.folder = directory_.path()}};
  std::vector<ProblemResult> results_;
  std::string messages_;
};

TEST_F(BroughtRobot, PlansReportsAndIsGuidedByItsOwnReports) {
  cell_.start();
  EXPECT_EQ(plan_with_server("--guidance auto --report yes"), 0) << messages_;
  ASSERT_EQ(results_.size(), 6U);
  for (const ProblemResult& result : results_) {
    EXPECT_TRUE(result.solved) << result.reason;
    EXPECT_NE(result.guidance_reason, "") << "nobody has experience yet";
  }
  EXPECT_NE(messages_.find("6 acknowledged, 0 pending, 0 refused"), std::string::npos) << messages_;

  EXPECT_EQ(plan_with_server("--guidance always"), 0) << messages_;
  ASSERT_EQ(results_.size(), 6U);
  for (const ProblemResult& result : results_) {
    EXPECT_TRUE(result.solved) << result.reason;
    EXPECT_TRUE(result.distribution_id) << messages_;
    EXPECT_EQ(result.sampling_mode, SamplingMode::Guided);
    EXPECT_EQ(result.guidance_reason.empty(), result.share > 0) << result.guidance_reason;
  }
}

TEST_F(BroughtRobot, ALabelOfAnotherRobotEndsTheRun) {
  cell_.start();
  EXPECT_EQ(plan_with_server("--label cell7"), 0) << messages_;
  const int code = plan("--base carriage --label cell7 --task past");
  EXPECT_EQ(code, 1) << messages_;
  EXPECT_TRUE(results_.empty());
  EXPECT_NE(messages_.find("cell7"), std::string::npos) << messages_;
  EXPECT_NE(messages_.find("nothing is planned"), std::string::npos) << messages_;
}

TEST_F(BroughtRobot, GoesAroundMeshesThatStandBesideTheProblemFile) {
  write("post.stl", test::BoxMesh({40, 40, 200}).binary_stl());
  Problem shapes = past_the_post(1), meshes = shapes, missing = shapes;
  for (Problem* problem : {&meshes, &missing}) {
    problem->scene.objects.clear();
    problem->scene.meshes = {{"post",
                              {.file = "post.stl", .scale = Eigen::Vector3d::Constant(0.001)},
                              Eigen::Isometry3d(Eigen::Translation3d(0.33, 0.33, 0))}};
  }
  missing.scene.meshes[0].mesh.file = "lost.stl";
  missing.name = "lost";
  // Where the goal touches it: what is said shows that the mesh is where the shape was.
  Problem blocked = meshes;
  blocked.name = "blocked";
  blocked.goal_configurations.col(0) << 0, M_PI / 4, 0, 0;
  write("problems.jsonl", json::to_json(shapes) + "\n" + json::to_json(meshes) + "\n" +
                              json::to_json(missing) + "\n" + json::to_json(blocked) + "\n");
  EXPECT_EQ(plan("--base base"), 0) << messages_;
  ASSERT_EQ(results_.size(), 4U);
  EXPECT_TRUE(results_[0].solved) << results_[0].reason;
  EXPECT_TRUE(results_[1].solved) << results_[1].reason;
  EXPECT_EQ(results_[1].collision_checks, results_[0].collision_checks) << "the same solid";
  EXPECT_FALSE(results_[2].solved);
  EXPECT_NE(results_[2].reason.find("scene object 'post': mesh 'lost.stl'"), std::string::npos)
      << results_[2].reason;
  EXPECT_FALSE(results_[3].solved);
  EXPECT_NE(results_[3].reason.find("touches 'post'"), std::string::npos) << results_[3].reason;
}

}  // namespace
}  // namespace kinship::brought_robot_test
