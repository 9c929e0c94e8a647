#include "client/experiments/station_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace kinship::experiments::machine_scene_test {
namespace {

constexpr std::uint64_t kSeed = 5;
constexpr int kInstances = 200;

StationScene drawn(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  return draw_machine_scene(generator);
}

const SceneObject& find(const StationScene& instance, const std::string& name) {
  for (const SceneObject& object : instance.scene.objects)
    if (object.name == name)
      return object;
  throw std::out_of_range("no object '" + name + "'");
}

/// A point of the task frame in an object's own.
Eigen::Vector3d within(const SceneObject& object, const Eigen::Vector3d& p_task_point) {
  return object.T_task_object.inverse() * p_task_point;
}

bool is_inside(const SceneObject& object, const Eigen::Vector3d& p_task_point) {
  const Eigen::Vector3d p = within(object, p_task_point);
  if (const auto* const box = std::get_if<BoxShape>(&object.shape))
    return (p.cwiseAbs().array() < box->size.array() / 2).all();
  const auto& cylinder = std::get<CylinderShape>(object.shape);
  return p.head<2>().norm() < cylinder.radius_m && std::abs(p.z()) < cylinder.length_m / 2;
}

TEST(MachineScene, EqualSeedsGiveEqualScenesAndOthersOthers) {
  const StationScene first = drawn(kSeed), second = drawn(kSeed), other = drawn(kSeed + 1);
  ASSERT_EQ(first.scene.objects.size(), second.scene.objects.size());
  for (std::size_t i = 0; i < first.scene.objects.size(); ++i)
    EXPECT_EQ(first.scene.objects[i].T_task_object.matrix(),
              second.scene.objects[i].T_task_object.matrix());
  EXPECT_EQ(first.T_task_pick.matrix(), second.T_task_pick.matrix());
  EXPECT_EQ(first.T_task_place.matrix(), second.T_task_place.matrix());
  for (const char* const moved : {"machine_back", "pallet", "fixture"})
    EXPECT_NE(find(first, moved).T_task_object.matrix(), find(other, moved).T_task_object.matrix());
}

TEST(MachineScene, TheMachineMovesByAFewCentimetresAndThePartAllOverThePallet) {
  double sum = 0, squares = 0, nearest = 1, farthest = -1;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const StationScene instance = drawn(seed);
    const double y = find(instance, "machine_top").T_task_object.translation().y();
    sum += y;
    squares += y * y;
    const double x = within(find(instance, "pallet"), instance.T_task_pick.translation()).x();
    nearest = std::min(nearest, x);
    farthest = std::max(farthest, x);
  }
  const double mean = sum / kInstances;
  EXPECT_NEAR(std::sqrt(squares / kInstances - mean * mean), 0.02, 0.005);
  EXPECT_LT(nearest, -0.12);
  EXPECT_GT(farthest, 0.12);
  EXPECT_GE(nearest, -0.14);
  EXPECT_LE(farthest, 0.14);
}

TEST(MachineScene, TheHandLooksDownAtBothAndTheGoalIsBehindTheDoor) {
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const StationScene instance = drawn(seed);
    EXPECT_NEAR(instance.T_task_pick.linear().col(2).z(), -1, 1e-12);
    EXPECT_NEAR(instance.T_task_place.linear().col(2).z(), -1, 1e-12);
    EXPECT_NEAR(instance.T_task_place.linear().determinant(), 1, 1e-12);
    const Eigen::Vector3d behind_sill =
        within(find(instance, "door_sill"), instance.T_task_place.translation());
    EXPECT_GT(behind_sill.x(), 0.1) << "seed " << seed;
    EXPECT_LT(std::abs(behind_sill.y()), 0.31) << "seed " << seed;
  }
}

TEST(MachineScene, TheHeldPartIsFreeAtThePickAndAtTheGoal) {
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const StationScene instance = drawn(seed);
    const Eigen::Vector3d half = instance.held.size / 2;
    for (const Eigen::Isometry3d& T_task_transfer : {instance.T_task_pick, instance.T_task_place})
      for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d sign((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1,
                                   (corner & 4) ? 1 : -1);
        const Eigen::Vector3d p =
            T_task_transfer * instance.T_transfer_held * half.cwiseProduct(sign);
        for (const SceneObject& object : instance.scene.objects)
          EXPECT_FALSE(is_inside(object, p)) << "seed " << seed << ": " << object.name;
      }
  }
}

TEST(MachineScene, TheDoorIsTheOnlyWayIn) {
  const StationScene instance = drawn(kSeed);
  const SceneObject& sill = find(instance, "door_sill");
  int open = 0;
  for (double y = -0.3; y <= 0.3; y += 0.01)
    for (double z = 0.01; z < 0.62; z += 0.01) {
      const double half_sill = std::get<BoxShape>(sill.shape).size.z() / 2;
      const Eigen::Vector3d p = sill.T_task_object * Eigen::Vector3d(0, y, z - half_sill);
      const bool is_open = std::ranges::none_of(
          instance.scene.objects, [&](const SceneObject& object) { return is_inside(object, p); });
      open += is_open ? 1 : 0;
      const bool is_door = std::abs(y) <= 0.19 + 1e-9 && z >= 0.18 - 1e-9 && z <= 0.53 + 1e-9;
      EXPECT_TRUE(is_door || !is_open) << y << ' ' << z;
    }
  EXPECT_NEAR(open * 1e-4, 0.38 * 0.35, 0.01) << "m^2 of door";
}

}  // namespace
}  // namespace kinship::experiments::machine_scene_test
