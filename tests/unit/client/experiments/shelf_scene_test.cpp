#include "client/experiments/station_scene.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace kinship::experiments::shelf_scene_test {
namespace {

constexpr std::uint64_t kSeed = 5;
constexpr int kInstances = 200;

StationScene drawn(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  return draw_shelf_scene(generator);
}

const SceneObject& find(const StationScene& instance, const std::string& name) {
  for (const SceneObject& object : instance.scene.objects)
    if (object.name == name)
      return object;
  throw std::out_of_range("no object '" + name + "'");
}

int occupants(const StationScene& instance) {
  int count = 0;
  for (const SceneObject& object : instance.scene.objects)
    if (object.name.starts_with("occupant_"))
      ++count;
  return count;
}

/// Whether a point in the task frame lies in a box of the scene.
bool inside(const SceneObject& object, const Eigen::Vector3d& p_task_point) {
  const auto* const box = std::get_if<BoxShape>(&object.shape);
  if (box == nullptr)
    return false;
  const Eigen::Vector3d p = object.T_task_object.inverse() * p_task_point;
  return (p.cwiseAbs().array() < box->size.array() / 2).all();
}

TEST(ShelfScene, EqualSeedsGiveEqualScenes) {
  const StationScene first = drawn(kSeed);
  const StationScene second = drawn(kSeed);
  ASSERT_EQ(first.scene.objects.size(), second.scene.objects.size());
  for (std::size_t i = 0; i < first.scene.objects.size(); ++i)
    EXPECT_EQ(first.scene.objects[i].T_task_object.matrix(),
              second.scene.objects[i].T_task_object.matrix());
  EXPECT_EQ(first.T_task_pick.matrix(), second.T_task_pick.matrix());
  EXPECT_EQ(first.T_task_place.matrix(), second.T_task_place.matrix());
}

TEST(ShelfScene, InstancesVaryByAFewCentimetres) {
  double sum = 0;
  double squares = 0;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const double y = drawn(seed).T_task_pick.translation().y();
    sum += y;
    squares += y * y;
  }
  const double mean = sum / kInstances;
  EXPECT_NEAR(std::sqrt(squares / kInstances - mean * mean), 0.02, 0.005);
}

TEST(ShelfScene, EveryCompartmentIsAGoalAndOneOrTwoOthersAreOccupied) {
  std::map<std::string, int> goals;
  std::map<int, int> occupied;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const StationScene instance = drawn(seed);
    const Eigen::Vector3d p =
        find(instance, "side_1").T_task_object.inverse() * instance.T_task_place.translation();
    ++goals[std::string(p.y() > 0 ? "left " : "right ") + (p.z() > 0 ? "upper" : "lower")];
    ++occupied[occupants(instance)];
  }
  EXPECT_EQ(goals.size(), 4U);
  for (const auto& [place, count] : goals)
    EXPECT_GT(count, kInstances / 10) << place;
  EXPECT_EQ(occupied.size(), 2U);
  EXPECT_GT(occupied[1], 0);
  EXPECT_GT(occupied[2], 0);
}

TEST(ShelfScene, TheGripperLooksDownAtThePickAndIntoTheShelfAtTheGoal) {
  const StationScene instance = drawn(kSeed);
  EXPECT_NEAR(instance.T_task_pick.linear().col(2).z(), -1, 1e-12);
  EXPECT_GT(instance.T_task_place.linear().col(2).x(), 0.98);
  EXPECT_NEAR(instance.T_task_pick.linear().determinant(), 1, 1e-12);
  EXPECT_NEAR(instance.T_task_place.linear().determinant(), 1, 1e-12);
}

TEST(ShelfScene, TheHeldBoxIsFreeAtThePickAndAtTheGoal) {
  const Eigen::Vector3d half = held_box().size / 2;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const StationScene instance = drawn(seed);
    for (const Eigen::Isometry3d& T_task_transfer : {instance.T_task_pick, instance.T_task_place})
      for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d sign((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1,
                                   (corner & 4) ? 1 : -1);
        const Eigen::Vector3d p = T_task_transfer * T_transfer_box() * half.cwiseProduct(sign);
        EXPECT_GT(p.z(), 0) << "seed " << seed;
        for (const SceneObject& object : instance.scene.objects)
          EXPECT_FALSE(inside(object, p)) << "seed " << seed << ": " << object.name;
      }
  }
}

}  // namespace
}  // namespace kinship::experiments::shelf_scene_test
