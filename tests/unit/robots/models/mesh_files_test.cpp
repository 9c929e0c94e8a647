#include "robots/models/mesh_files.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "robots/geometry/mesh.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::models::mesh_files_test {
namespace {

std::string found(const MeshFiles& files, const std::string& uri) {
  const auto file = files.find(uri);
  return file ? file->string() : file.error().message;
}

TEST(MeshFiles, FindsFilesByPackageRootAndName) {
  const MeshFiles files("/robots/arm", {{"arm_description", "/opt/arm"}, {"hand", "rel"}});
  EXPECT_EQ(found(files, "package://arm_description/meshes/l1.STL"), "/opt/arm/meshes/l1.STL");
  EXPECT_EQ(found(files, "package://hand/h.dae"), "rel/h.dae");
  EXPECT_EQ(found(files, "file:///opt/l2.stl"), "/opt/l2.stl");
  EXPECT_EQ(found(files, "meshes/l3.obj"), "/robots/arm/meshes/l3.obj");
  EXPECT_EQ(found(files, "/opt/l4.obj"), "/opt/l4.obj");
}

TEST(MeshFiles, NamesUriAndOptionOfWhatItCannotFind) {
  const MeshFiles files("/", {{"arm", "/opt/arm"}});
  EXPECT_EQ(found(files, "package://hand/h.dae"),
            "mesh 'package://hand/h.dae': the folder of package 'hand' is not known; give "
            "--package hand=DIR. Searched: AMENT_PREFIX_PATH (not set), ROS_PACKAGE_PATH (not "
            "set), package.xml in / and above");
  EXPECT_EQ(found(files, "package://../h.dae"), "mesh 'package://../h.dae': '..' is no package");
  EXPECT_EQ(found(files, "package://arm"), "mesh 'package://arm': must be package://NAME/FILE");
  EXPECT_EQ(found(files, "file://host/h.dae"),
            "mesh 'file://host/h.dae': must be file:///FILE with a path from the root");
  EXPECT_EQ(found(files, "http://a/h.dae"),
            "mesh 'http://a/h.dae': is not package://, file:// or a file name");
  EXPECT_EQ(found(files, ""), "mesh '': names no file");
}

/// Packages as ROS has them: installed, in a source tree, and around a URDF.
class RosPackages : public testing::Test {
 public:
  RosPackages() {
    add("installed/share/arm_description", "arm_description");
    add("src/group/arm_source", "arm_description");  // another folder name than the package's
    add("src/group/hand", "hand");
    add("src/.git/hidden", "hidden");
    add("src/ignored/away", "away");
    std::ofstream(folder_ / "src/ignored/COLCON_IGNORE").close();
    add("own", "own_description");
    std::filesystem::create_directories(folder_ / "own/robots/urdf");
  }
  ~RosPackages() override {
    unsetenv("AMENT_PREFIX_PATH");  // NOLINT(concurrency-mt-unsafe)
    unsetenv("ROS_PACKAGE_PATH");   // NOLINT(concurrency-mt-unsafe)
  }

 protected:
  void add(const std::string& folder, const std::string& name) {
    std::filesystem::create_directories(folder_.path() / folder);
    std::ofstream(folder_.path() / folder / "package.xml")
        << "<?xml version='1.0'?><package format='3'><name> " << name << "\n</name></package>";
  }
  void set(const char* variable, const std::string& value) {
    setenv(variable, value.c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  }
  std::string place(const std::string& inside) const { return (folder_.path() / inside).string(); }
  std::string find(const std::string& package, const PackageFolders& given = {}) const {
    return found(MeshFiles(folder_ / "own/robots/urdf", given), "package://" + package + "/m.stl");
  }

  test::TemporaryDirectory folder_;
};

TEST_F(RosPackages, AreFoundInstalledThenInSourcesThenAboveTheUrdf) {
  set("AMENT_PREFIX_PATH", place("none") + ":" + place("installed"));
  set("ROS_PACKAGE_PATH", place("src") + "::" + place("none"));
  EXPECT_EQ(find("arm_description"), place("installed/share/arm_description/m.stl"));
  EXPECT_EQ(find("hand"), place("src/group/hand/m.stl"));
  EXPECT_EQ(find("own_description"), place("own/m.stl"));
  EXPECT_EQ(find("hand", {{"hand", "/given"}}), "/given/m.stl");
  unsetenv("AMENT_PREFIX_PATH");  // NOLINT(concurrency-mt-unsafe)
  EXPECT_EQ(find("arm_description"), place("src/group/arm_source/m.stl"));
}

TEST_F(RosPackages, TheErrorNamesAllPlaces) {
  set("AMENT_PREFIX_PATH", place("none") + ":" + place("installed"));
  set("ROS_PACKAGE_PATH", place("src"));
  for (const std::string package : {"hidden", "away", "nowhere"})
    EXPECT_EQ(find(package),
              "mesh 'package://" + package + "/m.stl': the folder of package '" + package +
                  "' is not known; give --package " + package +
                  "=DIR. Searched: AMENT_PREFIX_PATH (" + place("none/share/" + package) + ", " +
                  place("installed/share/" + package) + "), ROS_PACKAGE_PATH (" + place("src") +
                  "), package.xml in " + place("own/robots/urdf") + " and above");
}

TEST(MeshFiles, ReadsAFileByItsEnding) {
  const test::TemporaryDirectory folder;
  const test::BoxMesh box({0.25, 0.5, 1});
  std::ofstream(folder / "box.STL", std::ios::binary) << box.binary_stl();
  const MeshFiles files(folder.path(), {});
  const auto corners = files.read("box.STL");
  ASSERT_TRUE(corners) << corners.error().message;
  EXPECT_TRUE((*corners)->rowwise().maxCoeff().isApprox(Eigen::Vector3d(0.25, 0.5, 1)));
}

TEST(MeshFiles, NamesFileAndLimitOfWhatItCannotRead) {
  const test::TemporaryDirectory folder;
  const std::string place = folder.path().string() + "/";
  const MeshFiles files(folder.path(), {{"p", folder.path()}});
  EXPECT_EQ(files.read("package://p/no.stl").error().message,
            "mesh 'package://p/no.stl': " + place + "no.stl: no such file");
  EXPECT_EQ(files.read("package://p/no.stl").error().code, ErrorCode::NotFound);

  std::ofstream(folder / "mesh.ply") << "ply";
  EXPECT_EQ(files.read("mesh.ply").error().message,
            "mesh 'mesh.ply': " + place + "mesh.ply: format 'ply' is not one of stl, obj, dae");

  std::ofstream(folder / "huge.stl").close();
  std::filesystem::resize_file(folder / "huge.stl", geometry::kMaxMeshBytes + 1);  // sparse
  EXPECT_EQ(files.read("huge.stl").error().message,
            "mesh 'huge.stl': " + place + "huge.stl: exceeds 64000000 bytes");
  EXPECT_EQ(files.read("huge.stl").error().code, ErrorCode::TooLarge);
}

TEST(ParsePackages, ReadsNamesAndFolders) {
  const test::TemporaryDirectory folder;
  const std::string place = folder.path().string();
  const auto packages = parse_packages({"a=" + place, "b=" + place});
  ASSERT_TRUE(packages) << packages.error().message;
  EXPECT_EQ(packages->at("a"), place);
  EXPECT_EQ(parse_packages({"a=" + place, "a=" + place}).error().message,
            "--package 'a=" + place + "': the package is named twice");
  EXPECT_EQ(parse_packages({"a=" + place + "/no"}).error().message,
            "--package 'a=" + place + "/no': no such folder");
  for (const std::string text : {"a", "=/tmp", "a=", ""})
    EXPECT_EQ(parse_packages({text}).error().message, "--package '" + text + "': must be NAME=DIR");
}

}  // namespace
}  // namespace kinship::models::mesh_files_test
