#include "client/experiments/station_scene.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <string>
#include <utility>

namespace kinship::experiments {

Eigen::Isometry3d upright(double x, double y, double z, double yaw_rad) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, z;
  T.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

Eigen::Isometry3d displaced(const Eigen::Vector3d& p, double deviation_m, double turn_rad,
                            Noise& noise) {
  const double dx = noise(deviation_m);
  const double dy = noise(deviation_m);
  return upright(p.x() + dx, p.y() + dy, p.z(), noise(turn_rad));
}

Eigen::Isometry3d looking_down() {
  Eigen::Isometry3d R = Eigen::Isometry3d::Identity();
  R.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return R;
}

void add_box(Scene& scene, std::string name, const Eigen::Vector3d& size,
             const Eigen::Isometry3d& T_task_object) {
  scene.objects.push_back({std::move(name), BoxShape{size}, T_task_object});
}

void add_table_top(Scene& scene, const Eigen::Vector2d& middle, const Eigen::Vector2d& size) {
  constexpr double kThick = 0.04;
  constexpr double kGap = 0.002;  // the top lies a little below z = 0
  add_box(scene, kTableName, {size.x(), size.y(), kThick},
          upright(middle.x(), middle.y(), -kThick / 2 - kGap));
}

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

namespace {

// All lengths in m. The shelf's frame: origin on the table below the middle of the opening, x into
// the shelf, y to its left, z up.
constexpr double kThickness = 0.015;  // of boards, sides and back
constexpr double kCompartmentWidth = 0.22;
constexpr double kCompartmentHeight = 0.22;
constexpr double kShelfDepth = 0.26;
constexpr double kFirstFloor = 0.12;  // top of the lowest board above the table
constexpr std::size_t kShelfColumns = 2;
constexpr std::size_t kShelfRows = 2;
constexpr std::size_t kCompartments = kShelfColumns * kShelfRows;

constexpr double kShelfNoise_m = 0.02;
constexpr double kTurnNoise_rad = 3 * std::numbers::pi / 180;
constexpr double kPickTurnNoise_rad = 8 * std::numbers::pi / 180;

Eigen::Isometry3d noisy(double x, double y, double z, double turn_noise_rad, Noise& noise) {
  return displaced({x, y, z}, kShelfNoise_m, turn_noise_rad, noise);
}

/// Middle of a compartment's floor at the opening, in the shelf's frame.
Eigen::Vector3d floor_of(std::size_t compartment) {
  const double column = static_cast<double>(compartment % kShelfColumns);
  const std::size_t floors_below = compartment / kShelfColumns;
  const double row = static_cast<double>(floors_below);
  const double pitch = kCompartmentWidth + kThickness;
  return {0, (column - (kShelfColumns - 1) / 2.0) * pitch,
          kFirstFloor + row * (kCompartmentHeight + kThickness)};
}

void add_shelf(Scene& scene, const Eigen::Isometry3d& T_task_shelf) {
  const double width = kShelfColumns * kCompartmentWidth + (kShelfColumns + 1) * kThickness;
  const double bottom = kFirstFloor - kThickness;
  const double height = kShelfRows * kCompartmentHeight + (kShelfRows + 1) * kThickness;
  for (std::size_t row = 0; row <= kShelfRows; ++row) {
    const double z = kFirstFloor + static_cast<double>(row) * (kCompartmentHeight + kThickness);
    add_box(scene, "board_" + std::to_string(row), {kShelfDepth, width, kThickness},
            T_task_shelf * upright(kShelfDepth / 2, 0, z - kThickness / 2));
  }
  for (std::size_t side = 0; side <= kShelfColumns; ++side) {
    const double y =
        (static_cast<double>(side) - kShelfColumns / 2.0) * (kCompartmentWidth + kThickness);
    add_box(scene, "side_" + std::to_string(side), {kShelfDepth, kThickness, height},
            T_task_shelf * upright(kShelfDepth / 2, y, bottom + height / 2));
  }
  add_box(scene, "back", {kThickness, width, height},
          T_task_shelf * upright(kShelfDepth + kThickness / 2, 0, bottom + height / 2));
  add_box(scene, "plinth", {kShelfDepth, width, bottom},
          T_task_shelf * upright(kShelfDepth / 2, 0, bottom / 2));
}

/// Puts boxes into one or two compartments other than the goal.
void add_occupants(Scene& scene, const Eigen::Isometry3d& T_task_shelf, std::size_t goal,
                   std::mt19937_64& generator) {
  const Eigen::Vector3d kSize(0.12, 0.10, 0.16);
  std::array<std::size_t, kCompartments - 1> others{};
  for (std::size_t i = 0; i < others.size(); ++i)
    others[i] = i < goal ? i : i + 1;
  std::shuffle(others.begin(), others.end(), generator);
  const std::size_t occupied = 1 + generator() % 2;
  Noise noise(generator);
  for (std::size_t i = 0; i < occupied; ++i) {
    const Eigen::Vector3d floor = floor_of(others[i]);
    const Eigen::Isometry3d T_shelf_box =
        noisy(floor.x() + 0.10, floor.y(), floor.z() + kSize.z() / 2, kTurnNoise_rad, noise);
    add_box(scene, "occupant_" + std::to_string(i), kSize, T_task_shelf * T_shelf_box);
  }
}

/// The table and what stands on it besides the shelf.
void add_table(Scene& scene, Noise& noise) {
  add_table_top(scene, {0.3, 0}, {1.8, 1.8});
  const Eigen::Isometry3d T_task_post = noisy(0.42, -0.16, 0.19, 0, noise);
  scene.objects.push_back({"post", CylinderShape{0.03, 0.38}, T_task_post});
  add_box(scene, "neighbour_left", {0.08, 0.08, 0.14},
          noisy(0.52, -0.46, 0.07, kPickTurnNoise_rad, noise));
  add_box(scene, "neighbour_right", {0.08, 0.08, 0.18},
          noisy(0.24, -0.58, 0.09, kPickTurnNoise_rad, noise));
}

}  // namespace

BoxShape held_box() { return {{0.07, 0.05, 0.12}}; }

Eigen::Isometry3d T_transfer_box() { return upright(0, 0, 0.08); }

StationScene draw_shelf_scene(std::mt19937_64& generator) {
  Noise noise(generator);
  StationScene instance;
  add_table(instance.scene, noise);
  const Eigen::Isometry3d T_task_shelf = noisy(0.50, 0.20, 0, kTurnNoise_rad, noise);
  add_shelf(instance.scene, T_task_shelf);
  const std::size_t goal = generator() % kCompartments;
  add_occupants(instance.scene, T_task_shelf, goal, generator);

  const double above_table = T_transfer_box().translation().z() + held_box().size.z() / 2 + 0.03;
  instance.T_task_pick =
      noisy(0.36, -0.42, above_table, kPickTurnNoise_rad, noise) * looking_down();

  // It looks into the shelf: a quarter turn about y away from the pick.
  Eigen::Isometry3d R_forward = Eigen::Isometry3d::Identity();
  R_forward.linear() << 0, 0, 1, 0, -1, 0, 1, 0, 0;
  const Eigen::Vector3d floor = floor_of(goal);
  const double sideways = noise(kShelfNoise_m / 2);
  const double inward = noise(kShelfNoise_m / 2);  // the palm ends at the opening
  const double above_floor = held_box().size.x() / 2 + 0.05;
  instance.T_task_place =
      T_task_shelf * upright(inward, floor.y() + sideways, floor.z() + above_floor) * R_forward;
  instance.held_name = "box";
  instance.held = held_box();
  instance.T_transfer_held = T_transfer_box();
  return instance;
}

}  // namespace kinship::experiments
