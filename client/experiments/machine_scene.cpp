#include "client/experiments/machine_scene.hpp"

#include <numbers>

namespace kinship::experiments {
namespace {

// All lengths in m. The machine's frame: origin on the table below its middle, x from its door to
// its back, y to its left as seen from the door, z up. The same machine as the tutorial's.
constexpr double kWall = 0.02;  // thickness
constexpr double kMachineDepth = 0.46, kMachineWidth = 0.66, kMachineHeight = 0.65;
constexpr double kDoorWidth = 0.38, kDoorBottom = 0.18, kDoorTop = 0.53;
constexpr double kRoomWidth = kMachineWidth - 2 * kWall;
constexpr double kRoomHeight = kMachineHeight - kWall;
constexpr double kFixtureRadius = 0.08, kFixtureHeight = 0.08;

constexpr double kPalletLength = 0.4, kPalletWidth = 0.3, kPalletHeight = 0.06;
constexpr double kPalletMargin = 0.06;  // the middle of a part is no nearer to its edges

constexpr double kPartHeight = 0.10;
constexpr double kPartFromPalm = 0.08;  // its middle
constexpr double kLifted = 0.03, kLowered = 0.02;

constexpr double kStandNoise_m = 0.02, kFixtureNoise_m = 0.015;
constexpr double kStandTurn_rad = 3 * std::numbers::pi / 180;
constexpr double kGraspTurn_rad = 8 * std::numbers::pi / 180;

/// From the palm to the part's end.
constexpr double kReach = kPartFromPalm + kPartHeight / 2;

/// The walls about the door, which is in the middle of the front.
void add_front(Scene& scene, const Eigen::Isometry3d& T_task_machine) {
  const double x = -(kMachineDepth + kWall) / 2;
  const double side = (kRoomWidth - kDoorWidth) / 2;
  const auto add = [&](const char* name, double y, double z, double width, double height) {
    add_box(scene, name, {kWall, width, height}, T_task_machine * upright(x, y, z));
  };
  add("door_sill", 0, kDoorBottom / 2, kRoomWidth, kDoorBottom);
  add("door_lintel", 0, (kDoorTop + kRoomHeight) / 2, kRoomWidth, kRoomHeight - kDoorTop);
  for (const double sign : {1.0, -1.0})
    add(sign > 0 ? "door_left" : "door_right", sign * (kDoorWidth + side) / 2,
        (kDoorBottom + kDoorTop) / 2, side, kDoorTop - kDoorBottom);
}

void add_machine(Scene& scene, const Eigen::Isometry3d& T_task_machine) {
  for (const double sign : {1.0, -1.0})
    add_box(scene, sign > 0 ? "machine_left" : "machine_right", {kMachineDepth, kWall, kRoomHeight},
            T_task_machine * upright(0, sign * (kRoomWidth + kWall) / 2, kRoomHeight / 2));
  add_box(scene, "machine_top", {kMachineDepth, kMachineWidth, kWall},
          T_task_machine * upright(0, 0, kRoomHeight + kWall / 2));
  add_box(scene, "machine_back", {kWall, kMachineWidth, kRoomHeight},
          T_task_machine * upright((kMachineDepth + kWall) / 2, 0, kRoomHeight / 2));
  add_front(scene, T_task_machine);
}

double somewhere(double half_range, std::mt19937_64& generator) {
  return std::uniform_real_distribution<double>(-half_range, half_range)(generator);
}

}  // namespace

StationScene draw_machine_scene(std::mt19937_64& generator) {
  Noise noise(generator);
  StationScene instance;
  add_table_top(instance.scene, {0.15, 0}, {2.0, 1.9});
  const Eigen::Isometry3d T_task_machine =
      displaced({0.48, -0.15, 0}, kStandNoise_m, kStandTurn_rad, noise);
  add_machine(instance.scene, T_task_machine);
  const Eigen::Isometry3d T_task_pallet =
      displaced({0, 0.42, 0}, kStandNoise_m, kStandTurn_rad, noise);
  add_box(instance.scene, "pallet", {kPalletLength, kPalletWidth, kPalletHeight},
          T_task_pallet * upright(0, 0, kPalletHeight / 2));
  const Eigen::Isometry3d T_task_fixture =
      T_task_machine * displaced({-0.06, 0, 0}, kFixtureNoise_m, 0, noise);
  instance.scene.objects.push_back({"fixture", CylinderShape{kFixtureRadius, kFixtureHeight},
                                    T_task_fixture * upright(0, 0, kFixtureHeight / 2)});

  const double x = somewhere(kPalletLength / 2 - kPalletMargin, generator);
  const double y = somewhere(kPalletWidth / 2 - kPalletMargin, generator);
  instance.T_task_pick = T_task_pallet *
                         upright(x, y, kPalletHeight + kReach + kLifted, noise(kGraspTurn_rad)) *
                         looking_down();
  instance.T_task_place =
      T_task_fixture * upright(0, 0, kFixtureHeight + kReach + kLowered) * looking_down();
  instance.held_name = "part";
  instance.held = {{0.06, 0.05, kPartHeight}};
  instance.T_transfer_held = upright(0, 0, kPartFromPalm);
  return instance;
}

}  // namespace kinship::experiments
