// Robots whose collision geometry is meshes, and a scene with a mesh: what a server, which reads
// none, filters with, and what it says of that.

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "client/link/outbox.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/problem_json.hpp"
#include "robots/models/loaded_robot.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/cell.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::mesh_robot_test {
namespace {

using std::chrono::seconds;

using test::Answer;

/// A planar arm of bars, each a mesh in a file named after its length in mm.
std::string arm_urdf(const std::vector<int>& lengths_mm) {
  std::string urdf = "<robot name='arm'><link name='base'/>";
  std::string parent = "base", at = "0 0 0";
  int number = 0;
  for (const int length_mm : lengths_mm) {
    const std::string link = "link" + std::to_string(++number);
    urdf += "<link name='" + link +
            "'><collision><origin xyz='0.04 -0.02 -0.02'/><geometry><mesh "
            "filename='bar" +
            std::to_string(length_mm) +
            ".stl' scale='0.001 0.001 0.001'/>"
            "</geometry></collision></link><joint name='joint" +
            std::to_string(number) + "' type='revolute'><parent link='" + parent +
            "'/><child link='" + link + "'/><origin xyz='" + at +
            "'/><axis xyz='0 0 1'/>"
            "<limit lower='-2.8' upper='2.8' effort='1' velocity='1'/></joint>";
    parent = link;
    at = std::to_string(length_mm / 1000.0) + " 0 0";
  }
  return urdf + "<link name='tip'/><joint name='end' type='fixed'><parent link='" + parent +
         "'/><child link='tip'/><origin xyz='" + at + "'/></joint></robot>";
}

const std::vector<int> kTeacher_mm = {400, 300, 250, 150}, kPupil_mm = {450, 250, 300, 120};

/// Past a rock, which is a mesh.
Problem past_the_rock(int number) {
  Problem problem;
  problem.name = "past-" + std::to_string(number);
  problem.T_task_base = Eigen::Isometry3d::Identity();
  problem.start = Eigen::Vector4d(-1.2, 0.5, 0.4, 0.05 * number);
  problem.goal_configurations = Eigen::Vector4d(1.1, -0.4, -0.5, 0.1 * number);
  problem.scene.meshes = {{"rock",
                           {.file = "rock.stl", .scale = Eigen::Vector3d::Constant(0.001)},
                           Eigen::Isometry3d(Eigen::Translation3d(0.7, -0.15, -0.1))}};
  problem.time_limit_s = 600;
  problem.seed = static_cast<std::uint64_t>(number);
  return problem;
}

class MeshRobots : public testing::Test {
 protected:
  MeshRobots() {
    cell_.start();
    for (const std::vector<int>& lengths_mm : {kTeacher_mm, kPupil_mm})
      for (const int length_mm : lengths_mm)
        write("bar" + std::to_string(length_mm) + ".stl",
              test::BoxMesh({length_mm - 80.0, 40, 40}).binary_stl());
    write("rock.stl", test::BoxMesh({300, 300, 200}).binary_stl());
    write("teacher.urdf", arm_urdf(kTeacher_mm));
    write("pupil.urdf", arm_urdf(kPupil_mm));
    std::string lines;
    for (int i = 0; i < 6; ++i)
      lines += json::to_json(past_the_rock(i)) + "\n";
    write("problems.jsonl", lines);
  }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_.path() / name, std::ios::binary) << text;
    return directory_.path() / name;
  }

  Answer plan_as_teacher() const {
    return cell_.run("kinship-plan",
                     "--without-meshes --base base --tip tip --axes x,y,yaw --label teacher "
                     "--task past "
                     "--guidance uniform --report yes --json --outbox " +
                         (directory_ / "plan_outbox").string() + " --robot " +
                         (directory_ / "teacher.urdf").string() + " --problems " +
                         (directory_ / "problems.jsonl").string());
  }

  Answer register_pupil(const std::string& more = "") const {
    return cell_.kinship("robots register " + (directory_ / "pupil.urdf").string() +
                         " --base base --tip tip --axes x,y,yaw --label pupil " + more);
  }

  /// The pupil as a client describes it, with the contents of its meshes.
  models::LoadedRobot described_pupil() const {
    models::RobotArguments arguments;
    arguments.source = directory_ / "pupil.urdf";
    arguments.base_link = "base";
    arguments.tip_link = "tip";
    arguments.axes = "x,y,yaw";
    arguments.label = "pupil";
    models::LoadedRobot robot = models::load_robot(arguments).value_or_throw();
    static_cast<void>(models::add_meshes(arguments, robot).value_or_throw());
    return robot;
  }

  /// Waits until the server filters for the pupil as it says here.
  testing::AssertionResult is_filtered_by(const std::string& geometry) {
    const auto deadline = std::chrono::steady_clock::now() + test::Cell::kEnough;
    while (pupil().geometry != geometry)
      if (std::chrono::steady_clock::now() > deadline)
        return testing::AssertionFailure() << pupil().geometry;
    return testing::AssertionSuccess();
  }

  Distribution fetch(const Digest& robot) {
    FetchRequest request;
    request.task = "past";
    request.robot = robot;
    request.T_task_base = Eigen::Isometry3d::Identity();
    request.deadline = seconds(120);
    const FetchReply reply = cell_.client().fetch(request).value_or_throw();
    EXPECT_TRUE(reply.distribution) << reply.message;
    return reply.distribution.value_or(Distribution());
  }

  RobotSummary pupil() {
    return json::row_from_json<RobotSummary>(cell_.ask(AdminVerb::ShowRobot, "pupil").rows.at(0))
        .value_or_throw();
  }

  const test::TemporaryDirectory directory_;
  test::Cell cell_{{.folder = directory_.path()}};
};

testing::AssertionResult has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos ? testing::AssertionSuccess()
                                              : testing::AssertionFailure() << text;
}

TEST_F(MeshRobots, AreFilteredWithSolidsAroundTheirMeshesAndTheServerSaysSo) {
  const Answer planned = plan_as_teacher();
  ASSERT_EQ(planned.code, 0) << planned.err;
  EXPECT_TRUE(has(planned.err, "'teacher', as the server filters for it: 4 links by 4 solids"));
  EXPECT_TRUE(
      has(planned.err, "is reported with solids around its meshes and clouds (approximate)"));
  EXPECT_TRUE(has(planned.err, "6 acknowledged"));

  const Answer registered = register_pupil("--without-meshes");
  ASSERT_EQ(registered.code, 0) << registered.err;
  EXPECT_TRUE(has(registered.out, "the server filters with: 4 links by 4 solids around meshes"));
  EXPECT_EQ(pupil().geometry_ms, 0);

  const Distribution distribution = fetch(pupil().robot);
  ASSERT_EQ(distribution.sources.size(), 1U);
  EXPECT_GT(distribution.sources[0].filter_checks, 0U);
  EXPECT_GT(distribution.sources[0].scene_collisions, 0U);
  EXPECT_LT(distribution.sources[0].scene_collisions, distribution.sources[0].filter_checks);
  EXPECT_EQ(distribution.sources[0].paths_with_scene, 6U);
  EXPECT_TRUE(has(distribution.filters, "self-collision: 4 links by 4 solids around meshes"));
  EXPECT_TRUE(has(distribution.filters,
                  "recorded scenes: those of 6 of 6 paths, 6 of them with solids around meshes"));
  const Answer explained =
      cell_.kinship("distributions explain --distribution " + distribution.id.hex());
  EXPECT_TRUE(has(explained.out, distribution.filters));
}

const std::string kByTriangles = "4 links by the triangles of their meshes";

TEST_F(MeshRobots, AreFilteredByTheTrianglesOfTheirMeshesWhichTravelOnce) {
  const Answer registered = register_pupil();
  ASSERT_EQ(registered.code, 0) << registered.err;
  EXPECT_TRUE(
      has(registered.out, "better geometry than before, it counts from now on: " + kByTriangles));
  EXPECT_TRUE(has(registered.out, "meshes: 4 meshes, 4 of them for collision; 4 of 4 contents"));
  EXPECT_EQ(cell_.status().meshes, 4U);
  const Answer shown = cell_.kinship("robots show pupil");
  EXPECT_TRUE(has(shown.out, "meshes      4 meshes, 4 of them for collision; 4 of 4 contents"));

  EXPECT_TRUE(
      has(register_pupil("--without-meshes").out, "the server filters with: " + kByTriangles));
  cell_.kill();
  cell_.start();
  EXPECT_EQ(pupil().geometry, kByTriangles);
  EXPECT_TRUE(has(register_pupil().out, "the server filters with: " + kByTriangles));
  EXPECT_EQ(cell_.status().meshes, 4U);
}

TEST_F(MeshRobots, WhatAClientThatDiedDidNotSendComesWhenAServerIsThere) {
  const models::LoadedRobot robot = described_pupil();
  {  // a client that dies after its first message, and a server that dies with it
    link::Outbox outbox(directory_ / "dead_client");
    outbox.keep_robot(robot.chain.digest(), robot.description);
    RobotDescription named = robot.description;
    named.contents.clear();
    const RegisterReply reply = cell_.client().register_robot(named).value_or_throw();
    EXPECT_EQ(reply.wanted.size(), 4U);
    EXPECT_TRUE(has(reply.meshes, "0 of 4 contents are here"));
    cell_.kill();
  }
  cell_.start();
  EXPECT_NE(pupil().geometry, kByTriangles);
  link::Client next({.domain = cell_.domain(), .outbox = directory_ / "dead_client"});
  EXPECT_TRUE(is_filtered_by(kByTriangles));
  // The client drops them when the reply comes, which is after the server has them.
  const link::Outbox outbox(directory_ / "dead_client");
  const auto deadline = std::chrono::steady_clock::now() + test::Cell::kEnough;
  while (!outbox.robots_with_contents().empty())
    ASSERT_LT(std::chrono::steady_clock::now(), deadline);
}

TEST_F(MeshRobots, OfAServerThatTakesNoMeshesSolidsServe) {
  cell_.kill();
  test::Cell other({.folder = directory_ / "other", .arguments = {"--stored-meshes-mb", "0"}});
  other.start();
  const Answer registered =
      other.kinship("robots register " + (directory_ / "pupil.urdf").string() +
                    " --base base --tip tip --axes x,y,yaw --label pupil");
  ASSERT_EQ(registered.code, 0) << registered.err;
  EXPECT_TRUE(has(registered.out, "the server filters with: 4 links by 4 solids around meshes"));
  EXPECT_TRUE(has(registered.out, "meshes: the server takes none"));
  EXPECT_EQ(other.status().meshes, 0U);
}

}  // namespace
}  // namespace kinship::mesh_robot_test
