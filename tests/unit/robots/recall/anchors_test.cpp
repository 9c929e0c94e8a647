#include "robots/recall/anchors.hpp"

#include <gtest/gtest.h>

#include <initializer_list>
#include <utility>

namespace kinship::recall::anchors_test {
namespace {

using Names = std::vector<std::string>;

Eigen::Isometry3d at(double x, double yaw_rad = 0) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, 0.2, 0.3) *
                           Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
}

using Scene = std::vector<SceneObject>;

Scene boxes(std::initializer_list<std::pair<const char*, Eigen::Isometry3d>> objects) {
  Scene scene;
  for (const auto& [name, T_task_object] : objects)
    scene.push_back({name, BoxShape{{0.1, 0.1, 0.1}}, T_task_object});
  return scene;
}

Names chosen(const std::vector<Scene>& scenes, std::size_t most = 2) {
  std::vector<const Scene*> pointers;
  for (const Scene& scene : scenes)
    pointers.push_back(&scene);
  return choose_anchors(pointers, most);
}

const Eigen::Isometry3d kMotion = at(0.5, 0.4);

TEST(Anchors, TheLargestGroupThatMovesAsOneComesFirst) {
  const Scene first = boxes({{"cup", at(0)},
                             {"tray", at(0.1)},
                             {"left", at(1)},
                             {"top", at(2)},
                             {"right", at(3)},
                             {"floor", at(4)}});
  Scene second = first;
  for (const std::size_t i : {0U, 1U})
    second[i].T_task_object = at(0.3) * second[i].T_task_object;
  for (const std::size_t i : {2U, 3U, 4U})
    second[i].T_task_object = kMotion * second[i].T_task_object;
  EXPECT_EQ(chosen({first, second}), (Names{"left", "cup"}));
  EXPECT_EQ(chosen({first, second}, 1), Names{"left"});
  EXPECT_EQ(chosen({second, first}), (Names{"left", "cup"}));
}

TEST(Anchors, NothingThatMovesHasNone) {
  const Scene scene = boxes({{"left", at(1)}, {"right", at(2)}});
  EXPECT_EQ(chosen({scene, scene, scene}), Names());
  EXPECT_EQ(chosen({scene}), Names());
  EXPECT_EQ(chosen({}), Names());
}

TEST(Anchors, LessThanAMillimetreIsNoMotion) {
  const Scene first = boxes({{"left", at(1)}, {"right", at(2)}});
  Scene second = first;
  for (SceneObject& object : second)
    object.T_task_object.translation().x() += 5e-4;
  EXPECT_EQ(chosen({first, second}), Names());
  for (SceneObject& object : second)
    object.T_task_object.translation().x() += 5e-3;
  EXPECT_EQ(chosen({first, second}), Names{"left"});
}

TEST(Anchors, AnObjectAloneIsOneOnlyIfThereAreNoGroups) {
  const Scene first = boxes({{"cup", at(0)}, {"left", at(1)}, {"right", at(2)}});
  Scene alone = first;
  alone[0].T_task_object = at(0.3);
  EXPECT_EQ(chosen({first, alone}), Names{"cup"});
  Scene both = alone;
  for (const std::size_t i : {1U, 2U})
    both[i].T_task_object = kMotion * both[i].T_task_object;
  EXPECT_EQ(chosen({first, both}), Names{"left"});
}

TEST(Anchors, OnlyWhatIsInAllScenesAndHasOneKindOfShape) {
  const Scene first = boxes({{"cup", at(0)}, {"pot", at(1)}, {"box", at(2)}});
  Scene second = first;
  for (SceneObject& object : second)
    object.T_task_object = kMotion * object.T_task_object;
  Scene third = second;
  third[0].name = "another";
  third[1].shape = SphereShape{0.1};
  EXPECT_EQ(chosen({first, second}), Names{"cup"});
  EXPECT_EQ(chosen({first, second, third}), Names{"box"});
}

TEST(Anchors, WhatMovesApartInOneSceneIsNoGroup) {
  const Scene first = boxes({{"a", at(0)}, {"b", at(1)}});
  Scene second = first, third = first;
  for (SceneObject& object : second)
    object.T_task_object = kMotion * object.T_task_object;
  third[0].T_task_object = kMotion * third[0].T_task_object;
  EXPECT_EQ(chosen({first, second, third}), (Names{"a", "b"}));
}

}  // namespace
}  // namespace kinship::recall::anchors_test
