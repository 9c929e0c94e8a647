#include "robots/models/mesh_files.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/box_mesh.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::models::scene_meshes_test {
namespace {

class SceneMeshesTest : public testing::Test {
 protected:
  SceneMeshesTest() {
    std::ofstream(folder_ / "box.stl", std::ios::binary) << test::BoxMesh({1, 2, 4}).binary_stl();
  }

  test::TemporaryDirectory folder_;
  SceneMeshes meshes_{folder_.path(), {}};
  std::vector<AttachedObject> none_;
};

TEST_F(SceneMeshesTest, ScalesWhatItReadsAndSharesIt) {
  Scene scene, other;
  scene.meshes = {{"a", {.file = "box.stl"}}, {"b", {.file = "box.stl", .scale = {1, -0.5, 0.25}}}};
  other.meshes = {{"c", {.file = "box.stl"}}};
  ASSERT_FALSE(meshes_.read(scene, none_));
  std::filesystem::remove(folder_ / "box.stl");  // known by now
  ASSERT_FALSE(meshes_.read(other, none_));
  EXPECT_EQ(other.meshes[0].mesh.triangles, scene.meshes[0].mesh.triangles);
  const Eigen::Matrix3Xd& scaled = *scene.meshes[1].mesh.triangles;
  EXPECT_EQ(scaled.cols(), 36);
  EXPECT_EQ(scaled.rowwise().maxCoeff(), Eigen::Vector3d(1, 0, 1));
  EXPECT_EQ(scaled.rowwise().minCoeff(), Eigen::Vector3d(0, -1, 0));
}

TEST_F(SceneMeshesTest, ReadsWhatIsHeldToo) {
  Scene scene;
  std::vector<AttachedObject> attached(2);
  attached[1].mesh = Mesh{.file = "box.stl"};
  ASSERT_FALSE(meshes_.read(scene, attached));
  EXPECT_FALSE(attached[0].mesh);
  EXPECT_EQ(attached[1].mesh->triangles->cols(), 36);
}

TEST_F(SceneMeshesTest, ReadsAPointCloudOnceForEachSizeOfVoxels) {
  std::ofstream(folder_ / "table.xyz") << "0.01 0.01 0\n0.012 0.011 0\n0.31 0.01 0\n";
  Scene scene;
  scene.clouds = {
      {"a", {"table.xyz", 0.02}}, {"b", {"table.xyz", 0.5}}, {"c", {"table.xyz", 0.02}}};
  ASSERT_FALSE(meshes_.read(scene, none_));
  EXPECT_EQ(scene.clouds[0].cloud.voxels->cols(), 2);
  EXPECT_EQ(scene.clouds[1].cloud.voxels->cols(), 1);
  EXPECT_EQ(scene.clouds[2].cloud.voxels, scene.clouds[0].cloud.voxels);
  scene.clouds = {{"d", {"lost.pcd"}}};
  EXPECT_EQ(meshes_.read(scene, none_)->message.find("scene object 'd': point cloud 'lost.pcd': "),
            0U);
  std::ofstream(folder_ / "empty.xyz") << "# nothing\n";
  scene.clouds = {{"e", {"empty.xyz"}}};
  EXPECT_EQ(meshes_.read(scene, none_)->message,
            "scene object 'e': point cloud 'empty.xyz': holds no point");
}

TEST_F(SceneMeshesTest, VoxelsFinerThanTheCubesOfAMapAreRefused) {
  std::ofstream(folder_ / "seen.ot") << "# Octomap OcTree file\nid OcTree\nres 0.05\ndata\n";
  Scene scene;
  scene.clouds = {{"a", {"seen.ot", 0.02}}};
  EXPECT_EQ(meshes_.read(scene, none_)->message,
            "scene object 'a': point cloud 'seen.ot': a map of cubes of 0.05 m, but voxels of 0.02 "
            "m: give \"voxel\": 0.05, or a larger one");
  scene.clouds = {{"a", {"seen.ot", 0.05}}};
  EXPECT_EQ(meshes_.read(scene, none_)->message,
            "scene object 'a': point cloud 'seen.ot': holds no point");
}

TEST_F(SceneMeshesTest, NamesTheObjectWhoseFileCannotBeRead) {
  Scene scene;
  scene.meshes = {{"a", {.file = "lost.stl"}}};
  auto error = meshes_.read(scene, none_);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->message.find("scene object 'a': mesh 'lost.stl'"), 0U) << error->message;
  std::vector<AttachedObject> attached(1);
  attached[0].name = "can";
  attached[0].mesh = Mesh{.file = "package://unknown/can.stl"};
  scene.meshes.clear();
  error = meshes_.read(scene, attached);
  ASSERT_TRUE(error);
  EXPECT_NE(error->message.find("attached object 'can'"), std::string::npos) << error->message;
  EXPECT_NE(error->message.find("--package unknown=DIR"), std::string::npos) << error->message;
}

}  // namespace
}  // namespace kinship::models::scene_meshes_test
