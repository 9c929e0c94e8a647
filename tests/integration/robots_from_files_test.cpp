// Robots as users bring them: a twin of a known arm, collision meshes in a package, an SRDF.

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "proto/json/problem_json.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::robots_from_files_test {
namespace {

const std::string kModels = test::source_dir() + "/robots/models/";

using test::Answer;

class RobotsFromFiles : public testing::Test {
 protected:
  Answer run(const std::string& program, std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(),
                     {"--domain", std::to_string(domain_.number()), "--timeout", "60"});
    return test::run_to_end(program, arguments);
  }

  std::string write(const char* name, const std::string& text) const {
    std::ofstream(directory_ / name, std::ios::binary) << text;
    return directory_ / name;
  }

  /// A pointer of half a metre on a turning joint; its shape is a mesh in mm.
  std::string write_pointer() const {
    write("Pointer.STL", test::BoxMesh({500, 20, 20}).binary_stl());
    return write("pointer.urdf", R"(<robot name="pointer"><link name="base"/><link name="arm">
      <collision><geometry>
        <mesh filename="package://pointer/Pointer.STL" scale="0.001 0.001 0.001"/>
      </geometry></collision></link>
      <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
        <axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint></robot>)");
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
};

TEST_F(RobotsFromFiles, ATwinIsToldWhomItIsLike) {
  const test::ServerProcess server(
      {.store = directory_ / "fleet.db", .domain = domain_.number(), .arguments = {}});
  const Answer first = run("kinship", {"robots", "register", kModels + "ur10e"});
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(first.out.find("same arm"), std::string::npos) << first.out;

  std::string text = test::read_text(kModels + "ur10e/robot.urdf");
  const std::string nominal = "0.6127", calibrated = "0.6132";
  for (std::size_t at = 0; (at = text.find(nominal, at)) != std::string::npos;)
    text.replace(at, nominal.size(), calibrated);
  const std::string twin = write("cell7.urdf", text);
  const std::vector<std::string> arguments = {"robots",           "register", twin,    "--base",
                                              "base_link",        "--tip",    "tool0", "--transfer",
                                              "0 0 0.06 0 0 0 1", "--label",  "cell7"};
  const Answer second = run("kinship", arguments);
  EXPECT_EQ(second.code, 0) << second.err;
  EXPECT_NE(second.out.find("the same arm as ur10e"), std::string::npos) << second.out;
}

TEST_F(RobotsFromFiles, CollisionMeshesAreNotNeededToRegister) {
  const test::ServerProcess server(
      {.store = directory_ / "fleet.db", .domain = domain_.number(), .arguments = {}});
  std::vector<std::string> arguments = {"robots", "register",   write_pointer(),
                                        "--base", "base",       "--tip",
                                        "arm",    "--transfer", "0 0 0 0 0 0 1"};
  const Answer without = run("kinship", arguments);
  EXPECT_EQ(without.code, 0) << without.err;
  EXPECT_NE(without.err.find("without collision geometry: link 'arm': mesh "
                             "'package://pointer/Pointer.STL'"),
            std::string::npos)
      << without.err;
  EXPECT_NE(without.err.find("--package pointer=DIR"), std::string::npos) << without.err;

  arguments.insert(arguments.end(), {"--package", "pointer=" + directory_.path().string()});
  const Answer with = run("kinship", arguments);
  EXPECT_EQ(with.code, 0) << with.err;
  EXPECT_EQ(with.err, "");
}

TEST_F(RobotsFromFiles, PlanningTakesMeshesFromTheirPackage) {
  const std::string way = R"("start": [-1], "goal": {"configurations": [[1]]}, "seed": 1)";
  const std::string problems =
      write("problems.jsonl",
            R"({"name": "free", )" + way + "}\n" + R"({"name": "blocked", )" + way +
                R"(, "scene": {"boxes": [{"name": "post", "pose": [0.45, 0, 0, 0, 0, 0, 1],)"
                R"( "size": [0.02, 0.02, 0.5]}]}})"
                "\n");
  std::vector<std::string> arguments = {problems, write_pointer(), "--base",       "base",
                                        "--tip",  "arm",           "--max-checks", "2000"};
  const Answer without = run("kinship-plan", arguments);
  EXPECT_EQ(without.code, 2);
  EXPECT_NE(without.err.find("--package pointer=DIR"), std::string::npos) << without.err;

  arguments.insert(arguments.end(), {"--package", "pointer=" + directory_.path().string()});
  const Answer with = run("kinship-plan", arguments);
  EXPECT_EQ(with.code, 0) << with.err;
  const std::size_t end = with.out.find('\n');
  const auto free = json::problem_result_from_json(with.out.substr(0, end));
  const auto blocked = json::problem_result_from_json(with.out.substr(end + 1));
  ASSERT_TRUE(free && blocked) << with.out;
  EXPECT_TRUE(free->solved);
  EXPECT_FALSE(blocked->solved);
}

}  // namespace
}  // namespace kinship::robots_from_files_test
