#include "client/guided/scene_record.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/box_mesh.hpp"
#include "tests/unit/client/planner/planar_problem.hpp"

namespace kinship::guided::scene_record_test {
namespace {

const kinematics::Chain& chain() {
  static const kinematics::Chain kChain = test::planar_robot().chain;
  return kChain;
}

AttachedObject can_on(const std::string& link) {
  return {"can",
          link,
          CylinderShape{0.03, 0.1},
          Eigen::Isometry3d(Eigen::Translation3d(0.4, 0, 0)),
          {"l3"}};
}

TEST(SceneRecord, WhatTheTipHoldsIsSaidInTheTransferFrame) {
  Problem problem = test::wall_problem();
  problem.attached.push_back(can_on("l4"));
  const RecordedScene scene = record_scene(chain(), problem).value_or_throw();
  ASSERT_EQ(scene.objects.size(), 1U);
  EXPECT_EQ(scene.objects[0].name, "wall");
  ASSERT_EQ(scene.held.size(), 1U);
  EXPECT_EQ(scene.held[0].name, "can");
  // The transfer frame is 0.3 m out on l4, the can 0.4 m.
  EXPECT_TRUE(scene.held[0].T_transfer_object.isApprox(
      Eigen::Isometry3d(Eigen::Translation3d(0.1, 0, 0)), 1e-12));
}

TEST(SceneRecord, WhatAnotherLinkCarriesAndPairsWithLinksAreLeftOut) {
  Problem problem = test::wall_problem();
  problem.attached = {can_on("l2"), can_on("l4")};
  problem.attached[0].name = "cable";
  problem.allowed_collisions = {{"l1", "wall"}, {"can", "wall"}, {"cable", "wall"}};
  const RecordedScene scene = record_scene(chain(), problem).value_or_throw();
  ASSERT_EQ(scene.held.size(), 1U);
  EXPECT_EQ(scene.held[0].name, "can");
  ASSERT_EQ(scene.allowed_collisions.size(), 1U);
  EXPECT_EQ(scene.allowed_collisions[0], std::pair(std::string("can"), std::string("wall")));
}

TEST(SceneRecord, TheConstraintIsTheProblems) {
  Problem problem = test::wall_problem();
  EXPECT_FALSE(record_scene(chain(), problem)->constraint);
  problem.scene = {};
  problem.constraint.emplace();
  problem.constraint->T_task_region.translation().z() = 0.5;
  problem.constraint->bounds.row(1).setConstant(std::numeric_limits<double>::infinity());
  const RecordedScene scene = record_scene(chain(), problem).value_or_throw();
  ASSERT_TRUE(scene.constraint);
  EXPECT_EQ(scene.constraint->bounds, problem.constraint->bounds);
  EXPECT_EQ(scene.constraint->T_task_region.matrix(), problem.constraint->T_task_region.matrix());
  EXPECT_TRUE(scene.objects.empty());
}

TEST(SceneRecord, TooLargeASceneIsAnError) {
  Problem problem = test::wall_problem();
  problem.scene.objects.assign(3000, problem.scene.objects[0]);
  EXPECT_EQ(record_scene(chain(), problem).error().message, "scene: 3000 objects exceed 2048");
}

TEST(SceneRecord, MeshesAreSolidsAroundThemThatHaveTheirNames) {
  const auto rock =
      std::make_shared<const Eigen::Matrix3Xd>(kinship::test::BoxMesh({1, 2, 3}).triangles());
  Problem problem = test::wall_problem();
  const Eigen::Isometry3d T_task_rock(Eigen::Translation3d(5, 0, 0));
  problem.scene.meshes = {{"rock", {.file = "rock.stl", .triangles = rock}, T_task_rock}};
  problem.attached = {can_on("l4")};
  problem.attached[0].mesh = Mesh{.file = "can.stl", .triangles = rock};
  problem.allowed_collisions = {{"can", "rock"}};
  SceneRecords records;
  const RecordedScene scene = records.record(chain(), problem).value_or_throw();
  ASSERT_EQ(scene.objects.size(), 2U);
  EXPECT_FALSE(scene.objects[0].approximate) << "the wall";
  EXPECT_TRUE(scene.objects[1].approximate);
  EXPECT_EQ(scene.objects[1].name, "rock");
  EXPECT_NEAR(std::get<BoxShape>(scene.objects[1].shape).size.prod(), 6, 1e-6);
  EXPECT_TRUE(
      scene.objects[1].T_task_object.translation().isApprox(Eigen::Vector3d(5.5, 1, 1.5), 1e-6));
  ASSERT_EQ(scene.held.size(), 1U);
  EXPECT_TRUE(scene.held[0].approximate);
  EXPECT_TRUE(
      scene.held[0].T_transfer_object.translation().isApprox(Eigen::Vector3d(0.6, 1, 1.5), 1e-6));
  EXPECT_EQ(scene.allowed_collisions.size(), 1U);
  EXPECT_EQ(content_digest(records.record(chain(), problem).value_or_throw()),
            content_digest(scene));
}

TEST(SceneRecord, APointCloudIsBoxesAroundItsVoxels) {
  constexpr double kVoxel_m = 0.1;
  Eigen::Matrix3Xd row(3, 4);  // of four voxels along x
  row << 0.05, 0.15, 0.25, 0.35, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05;
  Problem problem = test::wall_problem();
  const Eigen::Isometry3d T_task_cloud(Eigen::Translation3d(5, 0, 0));
  problem.scene.clouds = {{"table", {"table.pcd", kVoxel_m}, T_task_cloud}};
  EXPECT_EQ(record_scene(chain(), problem).error().message,
            "'table' is a point cloud that was not read");
  problem.scene.clouds[0].cloud.voxels = std::make_shared<const Eigen::Matrix3Xd>(row);
  const RecordedScene scene = record_scene(chain(), problem).value_or_throw();
  ASSERT_EQ(scene.objects.size(), 5U);  // the wall, and a box a voxel of so few
  double least_x = 10;
  for (std::size_t i = 1; i < scene.objects.size(); ++i) {
    EXPECT_EQ(scene.objects[i].name, "table");
    EXPECT_TRUE(scene.objects[i].approximate);
    const auto& box = std::get<BoxShape>(scene.objects[i].shape);
    EXPECT_GE(box.size.minCoeff(), kVoxel_m - 1e-9);
    least_x =
        std::min(least_x, scene.objects[i].T_task_object.translation().x() - box.size.x() / 2);
  }
  EXPECT_LE(least_x, 5 + 1e-9);
}

TEST(SceneRecord, AMeshThatWasNotReadIsAnError) {
  Problem problem = test::wall_problem();
  problem.scene.meshes = {{"rock", {.file = "rock.stl"}}};
  EXPECT_EQ(record_scene(chain(), problem).error().message, "'rock' is a mesh that was not read");
}

}  // namespace
}  // namespace kinship::guided::scene_record_test
