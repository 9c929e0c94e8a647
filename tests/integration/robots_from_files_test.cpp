// Robots as users bring them: a twin of a known arm, collision meshes in a package, an SRDF.

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/support/box_mesh.hpp"
#include "tests/support/cell.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::robots_from_files_test {
namespace {

const std::string kModels = test::source_dir() + "/robots/models/";

using test::Answer;

class RobotsFromFiles : public testing::Test {
 protected:
  RobotsFromFiles() { cell_.start(); }

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

  const test::TemporaryDirectory directory_;
  test::Cell cell_{{.folder = directory_.path()}};
};

TEST_F(RobotsFromFiles, ATwinIsToldWhomItIsLike) {
  const Answer first = cell_.kinship("robots register " + kModels + "ur10e");
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(first.out.find("same arm"), std::string::npos) << first.out;

  std::string text = test::read_text(kModels + "ur10e/robot.urdf");
  const std::string nominal = "0.6127", calibrated = "0.6132";
  for (std::size_t at = 0; (at = text.find(nominal, at)) != std::string::npos;)
    text.replace(at, nominal.size(), calibrated);
  const std::string twin = write("cell7.urdf", text);
  const Answer second =
      cell_.kinship("robots register " + twin + " --base base_link --tip tool0 --label cell7" +
                    " --transfer '0 0 0.06 0 0 0 1'");
  EXPECT_EQ(second.code, 0) << second.err;
  EXPECT_NE(second.out.find("the same arm as ur10e"), std::string::npos) << second.out;
}

TEST_F(RobotsFromFiles, CollisionMeshesAreNotNeededToRegister) {
  const std::string line =
      "robots register " + write_pointer() + " --base base --tip arm --transfer '0 0 0 0 0 0 1'";
  const Answer without = cell_.kinship(line);
  EXPECT_EQ(without.code, 0) << without.err;
  EXPECT_NE(without.err.find("without collision geometry: link 'arm': mesh "
                             "'package://pointer/Pointer.STL'"),
            std::string::npos)
      << without.err;
  EXPECT_NE(without.err.find("--package pointer=DIR"), std::string::npos) << without.err;

  const Answer with = cell_.kinship(line + " --package pointer=" + directory_.path().string());
  EXPECT_EQ(with.code, 0) << with.err;
  EXPECT_EQ(with.err, "");
}

TEST_F(RobotsFromFiles, AFolderMadeByInitIsAllThatProgramsNeed) {
  const std::string urdf = write_pointer(), folder = directory_ / "mine";
  write("package.xml", "<package><name>pointer</name></package>");
  write("pointer.srdf",
        "<robot name='pointer'><disable_collisions link1='base' link2='arm'/></robot>");
  const Answer made =
      cell_.kinship("robots init " + urdf + " -o " + folder + " --transfer '0.5 0 0 0 0 0 1'");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_NE(made.out.find("found beside the URDF"), std::string::npos) << made.out;
  EXPECT_NE(made.out.find("found as ROS finds it"), std::string::npos) << made.out;
  const std::string text = test::read_text(folder + "/chain.toml");
  EXPECT_NE(text.find(R"(urdf = "../pointer.urdf")"), std::string::npos) << text;
  const Answer again = cell_.kinship("robots init " + urdf + " -o " + folder);
  EXPECT_EQ(again.code, 2);
  EXPECT_NE(again.err.find("--force replaces it"), std::string::npos) << again.err;
  EXPECT_EQ(test::read_text(folder + "/chain.toml"), text);

  const Answer registered = cell_.kinship("robots register " + folder);
  EXPECT_EQ(registered.code, 0) << registered.err;
  EXPECT_EQ(registered.err, "");
  EXPECT_NE(registered.out.find("by the triangles of their meshes"), std::string::npos)
      << registered.out;
  const std::string problems = write(
      "problems.jsonl", R"({"name": "p", "start": [0.0], "goal": {"configurations": [[1.0]]}})"
                        "\n");
  const Answer planned = cell_.run("kinship-plan", problems + " --robot " + folder + " --json");
  EXPECT_EQ(planned.code, 0) << planned.err;
  EXPECT_NE(planned.out.find(R"("solved":true)"), std::string::npos) << planned.out;
}

TEST_F(RobotsFromFiles, MeshesInMillimetresAreNotRegistered) {
  std::string text = test::read_text(write_pointer());
  const std::string scale = R"( scale="0.001 0.001 0.001")";
  const std::string urdf = write("mm.urdf", text.erase(text.find(scale), scale.size()));
  const std::string robot = urdf + " --base base --tip arm --transfer '0.5 0 0 0 0 0 1'" +
                            " --package pointer=" + directory_.path().string();
  for (const char* command : {"robots check ", "robots register ", "robots suggest-srdf "}) {
    const Answer answer = cell_.kinship(command + robot);
    EXPECT_EQ(answer.code, 2) << command;
    EXPECT_NE(answer.err.find("these are probably millimetres (0.5"), std::string::npos)
        << command << answer.err;
  }
  EXPECT_EQ(cell_.kinship("robots list --json").out.find("label"), std::string::npos);
}

}  // namespace
}  // namespace kinship::robots_from_files_test
