#include "client/experiments/studies/carrying_scene.hpp"

#include <array>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include "client/experiments/studies/instance_random.hpp"

namespace kinship::experiments {
namespace {

constexpr double kCarryingPlaceNoise_m = 0.02;
constexpr double kCarryingTurnNoise_rad = 0.04;
constexpr double kCarryingPickTurnNoise_rad = 0.06;

constexpr double kRimBelowPalm_m = 0.02;  // the fingers hold the container at its rim
constexpr double kLift_m = 0.025;         // of a carried container above the table

const Eigen::Vector3d kTableSize(0.8, 1.6, 0.04);
constexpr double kTableEdge_m = 0.2;  // before it stand the robots

/// Adds noise to a number; the argument is its standard deviation.
using Spread = std::function<double(double)>;

Eigen::Isometry3d at_height(const TablePose& pose, double z) {
  Eigen::Isometry3d T(Eigen::Translation3d(pose.x, pose.y, z));
  T.rotate(Eigen::AngleAxisd(pose.yaw_rad, Eigen::Vector3d::UnitZ()));
  return T;
}

TablePose noisy(const TablePose& pose, double turn_noise_rad, const Spread& spread) {
  TablePose moved = pose;
  moved.x += spread(kCarryingPlaceNoise_m);
  moved.y += spread(kCarryingPlaceNoise_m);
  moved.yaw_rad += spread(turn_noise_rad);
  return moved;
}

/// A box that stands on the table or on the floor of the bin.
void add_standing(Scene& scene, std::string name, const Eigen::Vector3d& size,
                  const Eigen::Isometry3d& T_task_floor) {
  scene.objects.push_back(
      {std::move(name), BoxShape{size}, T_task_floor * Eigen::Translation3d(0, 0, size.z() / 2)});
}

void add_bin(Scene& scene, const Bin& bin, const Eigen::Isometry3d& T_task_bin) {
  const double length = bin.length_m + 2 * bin.wall_m;
  const double x = (bin.length_m + bin.wall_m) / 2, y = (bin.width_m + bin.wall_m) / 2;
  const auto add_wall = [&](const char* name, double wall_x, double wall_y, double size_x,
                            double size_y) {
    add_standing(scene, name, {size_x, size_y, bin.height_m},
                 T_task_bin * Eigen::Translation3d(wall_x, wall_y, 0));
  };
  add_wall("bin_left", 0, y, length, bin.wall_m);
  add_wall("bin_right", 0, -y, length, bin.wall_m);
  add_wall("bin_back", x, 0, bin.wall_m, bin.width_m);
  add_wall("bin_front", -x, 0, bin.wall_m, bin.width_m);
}

/// \param taken  the place, 0 or 1, that another container has in a bin.
CarryingScene make_scene(const CarryingLayout& layout, const Spread& spread, std::size_t taken) {
  CarryingScene instance;
  constexpr double kBelow_m = 0.005;  // nothing that stands on the table touches it
  instance.scene.objects.push_back(
      {"table", BoxShape{kTableSize},
       Eigen::Isometry3d(Eigen::Translation3d(kTableEdge_m + kTableSize.x() / 2, 0,
                                              -kTableSize.z() / 2 - kBelow_m))});
  const Eigen::Isometry3d T_task_middle =
      at_height(noisy(layout.place, kCarryingTurnNoise_rad, spread), 0);
  const std::array<double, 2> places = {-layout.between_places_m / 2, layout.between_places_m / 2};
  const auto T_task_place = [&](std::size_t place, double z) -> Eigen::Isometry3d {
    return T_task_middle * Eigen::Translation3d(places.at(place), 0, z);
  };
  if (layout.bin) {
    add_bin(instance.scene, *layout.bin, T_task_middle);
    add_standing(instance.scene, "other_container", layout.container, T_task_place(taken, 0));
  }
  for (const TableObject& object : layout.objects)
    add_standing(instance.scene, object.name, object.size,
                 at_height(noisy(object.pose, kCarryingTurnNoise_rad, spread), 0));

  const Eigen::AngleAxisd down(std::numbers::pi, Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd half_turn(std::numbers::pi, Eigen::Vector3d::UnitZ());
  const double palm = kLift_m + layout.container.z() + kRimBelowPalm_m;
  instance.T_task_pick =
      at_height(noisy(layout.pick, kCarryingPickTurnNoise_rad, spread), palm) * down;
  const Eigen::Isometry3d T_task_goal = T_task_place(1 - taken, palm);
  instance.T_task_places = {T_task_goal * down, T_task_goal * half_turn * down};
  return instance;
}

}  // namespace

CarryingScene draw_carrying_scene(const CarryingLayout& layout, std::mt19937_64& generator) {
  std::uniform_int_distribution<std::size_t> coin(0, 1);
  const std::size_t taken = coin(generator);
  Noise noise(generator);
  return make_scene(layout, std::ref(noise), taken);
}

CarryingScene nominal_carrying_scene(const CarryingLayout& layout) {
  return make_scene(
      layout, [](double) { return 0.0; }, 0);
}

Eigen::Isometry3d T_transfer_container(const CarryingLayout& layout) {
  return Eigen::Isometry3d(Eigen::Translation3d(0, 0, kRimBelowPalm_m + layout.container.z() / 2));
}

}  // namespace kinship::experiments
