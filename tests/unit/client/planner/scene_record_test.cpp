#include "client/planner/scene_record.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/client/planner/planar_problem.hpp"

namespace kinship::planner::scene_record_test {
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

TEST(SceneRecord, AMeshIsNotSent) {
  Problem problem = test::wall_problem();
  problem.scene.meshes = {{"rock", {.file = "rock.stl"}}};
  EXPECT_EQ(record_scene(chain(), problem).error().message,
            "'rock' is a mesh, and the server keeps scenes of shapes only");
  problem.scene.meshes.clear();
  problem.attached = {can_on("l4")};
  problem.attached[0].mesh = Mesh{.file = "can.stl"};
  EXPECT_EQ(record_scene(chain(), problem).error().message,
            "'can' is a mesh, and the server keeps scenes of shapes only");
}

}  // namespace
}  // namespace kinship::planner::scene_record_test
