#include "robots/models/loaded_robot.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "robots/models/text_file.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::models::loaded_robot_test {
namespace {

const std::string kModels = test::source_dir() + "/robots/models/";

/// A URDF file of one joint whose arm is a mesh, and an SRDF beside it.
class MeshRobot : public testing::Test {
 protected:
  MeshRobot() {
    std::ofstream(folder_ / "arm.urdf") << R"(<robot name="arm"><link name="base">
      <visual><geometry><mesh filename="package://nowhere/base.dae"/></geometry></visual></link>
      <link name="arm"><collision><geometry>
        <mesh filename="package://arm/l1.STL" scale="0.001 0.001 0.001"/>
      </geometry></collision></link>
      <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
        <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)";
    std::ofstream(folder_ / "l1.STL", std::ios::binary)
        << test::BoxMesh({100, 100, 500}).binary_stl();
    write_srdf("arm");
    arguments_.source = folder_ / "arm.urdf";
    arguments_.base_link = "base";
    arguments_.tip_link = "arm";
    arguments_.packages = {"arm=" + folder_.path().string()};
  }

  void write_srdf(const std::string& link2) {
    std::ofstream(folder_ / "arm.srdf")
        << "<robot name='arm'><disable_collisions link1='base' link2='" << link2 << "'/></robot>";
  }

  std::string message() const {
    const auto robot = load_robot(arguments_);
    return robot ? "fine" : robot.error().message;
  }

  test::TemporaryDirectory folder_;
  RobotArguments arguments_;
};

TEST_F(MeshRobot, HasSolidsFittedAroundItsMeshes) {
  const LoadedRobot robot = load_robot(arguments_).value_or_throw();
  EXPECT_EQ(robot.description.label, "arm");
  EXPECT_EQ(robot.chain.dof(), 1);
  ASSERT_EQ(robot.shapes.shapes.size(), 1U);
  const geometry::LinkShape& shape = robot.shapes.shapes[0];
  EXPECT_TRUE(shape.approximate);
  EXPECT_NEAR(std::get<BoxShape>(shape.shape).size.prod(), 0.1 * 0.1 * 0.5, 1e-6);
  EXPECT_TRUE(shape.T_link_shape.translation().isApprox(Eigen::Vector3d(0.05, 0.05, 0.25), 1e-4));
}

TEST_F(MeshRobot, WithoutThePackageIsRefusedByLinkUriAndOption) {
  arguments_.packages.clear();
  EXPECT_NE(
      message().find("link 'arm': mesh 'package://arm/l1.STL': the folder of package 'arm' is "
                     "not known; give --package arm=DIR. Searched: AMENT_PREFIX_PATH"),
      std::string::npos);
  EXPECT_TRUE(describe_robot(arguments_));  // whoever needs no geometry is not in the way
}

TEST_F(MeshRobot, AMalformedPackageIsRefusedEvenIfNothingNeedsIt) {
  arguments_.packages.emplace_back("unused");
  EXPECT_EQ(message(), "--package 'unused': must be NAME=DIR");
  EXPECT_FALSE(describe_robot(arguments_));
}

/// The same robot, all said by a chain.toml in a folder of its own.
class MeshRobotFolder : public MeshRobot {
 protected:
  MeshRobotFolder() {
    std::filesystem::create_directories(folder_ / "mine");
    arguments_ = {.source = folder_ / "mine"};
  }
  void say(const std::string& more) {
    std::ofstream(folder_ / "mine" / kChainFile)
        << "urdf = '../arm.urdf'\nlabel = 'a'\nbase = 'base'\ntip = 'arm'\n"
           "transfer = [0, 0, 0, 0, 0, 0, 1]\n"
        << more;
  }
};

TEST_F(MeshRobotFolder, SaysPackagesAndSrdfItself) {
  say("srdf = '../arm.srdf'\n[packages]\narm = '..'\n");
  const LoadedRobot robot = load_robot(arguments_).value_or_throw();
  EXPECT_EQ(robot.description.label, "a");
  ASSERT_EQ(robot.shapes.shapes.size(), 1U);
  EXPECT_EQ(robot.shapes.never_colliding.size(), 1U);
  kinematics::RobotModel model(static_cast<const kinematics::RobotModel&>(robot));
  EXPECT_EQ(add_meshes(arguments_, model).value_or_throw().size(), 1U) << "of the base, not there";
  EXPECT_EQ(model.description.meshes.size(), 1U);
  EXPECT_EQ(model.description.contents.size(), 1U);
  arguments_.without_meshes = true;
  model.description.meshes.clear();
  EXPECT_TRUE(add_meshes(arguments_, model).value_or_throw().empty());
  EXPECT_TRUE(model.description.meshes.empty());
}

TEST_F(MeshRobotFolder, LooksForMeshesInItsMeshFolders) {
  say("mesh_folders = ['..']\n");
  EXPECT_EQ(message(), "fine");
  say("");
  EXPECT_NE(message().find("the folder of package 'arm' is not known"), std::string::npos);
}

TEST_F(MeshRobotFolder, FindsPackagesAsRosDoesBesideItsUrdf) {
  say("");
  std::ofstream(folder_ / "package.xml") << "<package><name>arm</name></package>";
  EXPECT_EQ(message(), "fine");
  std::filesystem::remove(folder_ / "package.xml");
  std::filesystem::create_directories(folder_ / "prefix/share/arm");
  std::filesystem::copy(folder_ / "l1.STL", folder_ / "prefix/share/arm/l1.STL");
  setenv("AMENT_PREFIX_PATH", (folder_ / "prefix").c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  EXPECT_EQ(message(), "fine");
  unsetenv("AMENT_PREFIX_PATH");  // NOLINT(concurrency-mt-unsafe)
}

TEST_F(MeshRobotFolder, InMillimetresIsRefused) {
  std::string text = read_text(folder_ / "arm.urdf", 10'000);
  const std::string scale = R"( scale="0.001 0.001 0.001")";
  std::ofstream(folder_ / "arm.urdf") << text.erase(text.find(scale), scale.size());
  say("[packages]\narm = '..'\n");
  EXPECT_NE(message().find("link 'arm' of an arm that reaches 0 m is 500 m long"),
            std::string::npos)
      << message();
}

TEST_F(MeshRobot, TakesPairsFromAnSrdf) {
  arguments_.srdf = folder_ / "arm.srdf";
  const LoadedRobot robot = load_robot(arguments_).value_or_throw();
  EXPECT_EQ(robot.shapes.never_colliding, (std::vector<std::pair<int, int>>{{0, 1}}));
}

TEST_F(MeshRobot, WarnsOfLinksThatAnSrdfNamesAndGoesOnWithoutThem) {
  arguments_.srdf = folder_ / "arm.srdf";
  EXPECT_TRUE(load_robot(arguments_).value_or_throw().warnings.empty());
  write_srdf("camera");
  const LoadedRobot robot = load_robot(arguments_).value_or_throw();
  EXPECT_EQ(robot.warnings,
            std::vector{arguments_.srdf.string() + ": the robot has no link 'camera' (line 1): a "
                                                   "pair that names it is left out"});
  EXPECT_TRUE(robot.description.never_colliding.empty());
}

TEST_F(MeshRobot, NamesTheSrdfThatIsWrong) {
  const std::string file = (folder_ / "arm.srdf").string();
  arguments_.srdf = file;
  std::ofstream(file) << "<robot><disable_collisions link1='base'/></robot>";
  EXPECT_EQ(message(), file + ": line 1: disable_collisions has no link2");
  std::filesystem::remove(file);
  EXPECT_EQ(message(), file + ": no such file");
}

TEST(LoadRobot, AnSrdfAddsToThePairsOfAFolder) {
  const test::TemporaryDirectory folder;
  std::ofstream(folder / "more.srdf")
      << "<robot><disable_collisions link1='panda_link0' link2='panda_link7'/></robot>";
  const LoadedRobot plain = load_robot({.source = kModels + "panda"}).value_or_throw();
  const LoadedRobot more =
      load_robot({.source = kModels + "panda", .srdf = folder / "more.srdf"}).value_or_throw();
  EXPECT_EQ(more.shapes.never_colliding.size(), plain.shapes.never_colliding.size() + 1);
}

TEST(LoadRobot, RefusesATransferFrameInMillimetres) {
  const auto robot = load_robot({.source = kModels + "panda", .transfer = "0 0 125 0 0 0 1"});
  ASSERT_FALSE(robot);
  EXPECT_NE(robot.error().message.find("these are probably millimetres (0.125 m)"),
            std::string::npos)
      << robot.error().message;
}

TEST(LoadRobot, SaysWhatIsWrongWithFilesChainAndShapes) {
  EXPECT_EQ(load_robot({.source = "/nowhere"}).error().code, ErrorCode::NotFound);
  const auto no_link = load_robot({.source = kModels + "panda", .base_link = "nothing"});
  ASSERT_FALSE(no_link);
  EXPECT_NE(no_link.error().message.find("'nothing'"), std::string::npos);
}

/// A URDF whose arm is drawn and has no collision solid.
class DrawnRobot : public testing::Test {
 protected:
  DrawnRobot() {
    std::ofstream(folder_ / "arm.urdf") << R"(<robot name="arm"><link name="base"/>
      <link name="arm"><visual><geometry><box size="0.1 0.1 0.5"/></geometry></visual></link>
      <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
        <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)";
    arguments_.source = folder_ / "arm.urdf";
    arguments_.base_link = "base";
    arguments_.tip_link = "arm";
  }
  std::string message() const {
    const auto robot = load_robot(arguments_);
    return robot ? "fine" : robot.error().message;
  }
  test::TemporaryDirectory folder_;
  RobotArguments arguments_;
};

TEST_F(DrawnRobot, IsRefusedForPlanningAndTheRefusalSaysWhatToDo) {
  EXPECT_NE(message().find("link 'arm' has <visual> and no <collision>"), std::string::npos)
      << message();
  EXPECT_NE(message().find("--without-collision LINK"), std::string::npos);
}

TEST_F(DrawnRobot, HasWhatIsDrawnForItsSolidsWhereThatIsAskedForAlsoForAServer) {
  arguments_.collision_from_visual = true;
  const LoadedRobot robot = load_robot(arguments_).value_or_throw();
  ASSERT_EQ(robot.shapes.shapes.size(), 1U);
  EXPECT_EQ(robot.shapes.from_visual, std::vector<int>{1});
  EXPECT_EQ(geometry::read_shapes(robot).value_or_throw().shapes.size(), 1U);
}

TEST_F(DrawnRobot, GoesWithoutSolidsWhereALinkIsSaidToNeedNone) {
  arguments_.without_collision = {"arm"};
  EXPECT_EQ(message(), "fine");
  arguments_.without_collision = {"leg"};
  EXPECT_EQ(message(), "--without-collision 'leg': the robot has no such link");
  arguments_.without_collision = {"arm"};
  arguments_.collision_from_visual = true;  // the link stays without
  EXPECT_TRUE(load_robot(arguments_).value_or_throw().shapes.shapes.empty());
}

}  // namespace
}  // namespace kinship::models::loaded_robot_test
