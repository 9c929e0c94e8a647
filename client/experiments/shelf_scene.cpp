#include "client/experiments/shelf_scene.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <string>
#include <utility>

namespace kinship::experiments {
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
