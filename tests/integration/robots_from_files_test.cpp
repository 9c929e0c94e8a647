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

}  // namespace
}  // namespace kinship::robots_from_files_test
