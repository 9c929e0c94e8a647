#include "proto/types/recorded_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "proto/types/limits.hpp"
#include "proto/types/pose.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::recorded_scene_test {
namespace {

constexpr std::uint64_t kSeed = 41;

Eigen::Isometry3d through_seven_numbers(const Eigen::Isometry3d& T) {
  return from_pose_array(to_pose_array(T)).value_or_throw();
}

TEST(RecordedScene, ContentDependsNeitherOnOrderNorOnRounding) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < 200; ++i) {
    const RecordedScene scene = values.recorded_scene();
    RecordedScene same = scene;
    std::shuffle(same.objects.begin(), same.objects.end(), values.generator());
    std::shuffle(same.held.begin(), same.held.end(), values.generator());
    for (auto& [first, second] : same.allowed_collisions)
      std::swap(first, second);
    for (SceneObject& object : same.objects)
      object.T_task_object = through_seven_numbers(object.T_task_object);
    for (HeldObject& held : same.held)
      held.T_transfer_object = through_seven_numbers(held.T_transfer_object);
    if (same.constraint) {
      same.constraint->T_task_region = through_seven_numbers(same.constraint->T_task_region);
      same.constraint->T_region_end = through_seven_numbers(same.constraint->T_region_end);
    }
    EXPECT_EQ(content_digest(same), content_digest(scene)) << i;
  }
}

TEST(RecordedScene, HalfTurnIsTheSameHoweverItsSignCame) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(1e-12, 1, 0, 0).normalized().toRotationMatrix();
  const RecordedScene one{{{"box", BoxShape{{1, 2, 3}}, T}}, {}, {}};
  T.linear() = Eigen::Quaterniond(1e-12, -1, 0, 0).normalized().toRotationMatrix();
  const RecordedScene other{{{"box", BoxShape{{1, 2, 3}}, T}}, {}, {}};
  EXPECT_EQ(content_digest(one), content_digest(other));
}

TEST(RecordedScene, OrientationOfASphereIsNoContent) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const RecordedScene one{{{"ball", SphereShape{1}, T}}, {}, {}};
  T.linear() = Eigen::AngleAxisd(1, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const RecordedScene other{{{"ball", SphereShape{1}, T}}, {}, {}};
  EXPECT_EQ(content_digest(one), content_digest(other));
}

TEST(RecordedScene, WhatDiffersHasAnotherContent) {
  RecordedScene scene{{{"table", BoxShape{{1, 2, 3}}}, {"pole", CylinderShape{1, 2}}},
                      {{"can", SphereShape{1}}},
                      {}};
  std::vector<RecordedScene> others(7, scene);
  others[0].objects[0].name = "tables";
  others[1].objects[0].T_task_object.translation().z() = 1e-6;
  others[2].objects[1].shape = CapsuleShape{1, 2};
  others[3].objects[1].shape = CylinderShape{1, 2.1};
  others[4].held.clear();
  others[5].allowed_collisions.emplace_back("can", "table");
  others[6].held[0].T_transfer_object.translation().x() = 1;
  std::set<Digest> digests = {content_digest(scene)};
  for (const RecordedScene& other : others)
    EXPECT_TRUE(digests.insert(content_digest(other)).second);
}

TEST(RecordedScene, ShapesComeBackFromTheirNumbers) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < 50; ++i) {
    const ShapeNumbers numbers = to_numbers(values.shape());
    const ShapeNumbers again = to_numbers(to_shape(numbers));
    EXPECT_EQ(again.kind, numbers.kind);
    EXPECT_EQ(again.sizes, numbers.sizes);
  }
  EXPECT_THROW(to_shape({4, {1, 1, 1}}), std::invalid_argument);
}

/// Level above z = 0, as a cup is carried.
TaskSpaceRegion level() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  TaskSpaceRegion region;
  region.bounds << -kInfinity, -0.5, 0, -0.1, -0.1, -kInfinity,  //
      kInfinity, 0.5, kInfinity, 0.1, 0.1, kInfinity;
  return region;
}

TEST(RecordedScene, AConstraintIsContent) {
  RecordedScene scene;
  std::set<Digest> digests = {content_digest(scene)};
  std::vector<TaskSpaceRegion> others(8, level());
  others[1].T_task_region.translation().z() = 1e-6;
  others[2].T_region_end.translation().z() = 1e-6;
  others[3].bounds(0, 0) = -1e9;
  others[4].bounds(1, 0) = 1e9;
  others[5].bounds(1, 5) = M_PI;
  others[6].bounds(0, 1) = 0.5;
  others[7] = {};
  for (const TaskSpaceRegion& other : others) {
    scene.constraint = other;
    EXPECT_TRUE(digests.insert(content_digest(scene)).second);
  }
  scene.constraint = level();
  scene.constraint->bounds(0, 1) += 1e-11;
  EXPECT_FALSE(digests.insert(content_digest(scene)).second);
}

TEST(RecordedScene, AConstraintThatCannotBeKeptIsNamed) {
  RecordedScene scene;
  scene.constraint = level();
  EXPECT_FALSE(check_scene(scene));
  scene.constraint->bounds(0, 4) = 0.2;
  EXPECT_EQ(check_scene(scene)->message,
            "scene: constraint: Bw of pitch: lower 0.2 exceeds upper 0.1");
  scene.constraint->bounds(0, 4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(check_scene(scene)->message, "scene: constraint: Bw of pitch: is not a number");
  scene.constraint = level();
  scene.constraint->T_task_region.translation().x() = 2000;
  EXPECT_EQ(check_scene(scene)->message,
            "scene: constraint: T0_w: pose: coordinate 2000 m exceeds 1000 m; these are probably "
            "millimetres");
  scene.constraint = level();
  scene.constraint->T_region_end.linear() *= 2;
  EXPECT_EQ(check_scene(scene)->message, "scene: constraint: Tw_e is not a rigid transform");
}

TEST(RecordedScene, BytesCountSolidsPairsNamesAndTheConstraint) {
  RecordedScene scene{
      {{"table", BoxShape{{1, 2, 3}}}}, {{"can", SphereShape{1}}}, {{"can", "table"}}};
  EXPECT_EQ(scene_bytes(scene), 2 * 96 + 16 + 2 * 8U);
  scene.constraint = level();
  EXPECT_EQ(scene_bytes(scene), 2 * 96 + 16 + 2 * 8 + 216U) << "proto/CONTRACT.md says so";
}

}  // namespace
}  // namespace kinship::recorded_scene_test
