#pragma once

#include <Eigen/Geometry>
#include <numbers>
#include <random>
#include <string>

#include "proto/types/task_space_region.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/region_constraint.hpp"

namespace kinship::test {

/// A hand that points down carries an open container over a post into the free half of a bin; it
/// must not tilt. The base stands at the origin, level with the table.
struct CarryingCell {
  collision::Surroundings surroundings;
  TaskSpaceRegion upright;
  Eigen::Isometry3d T_base_pick = Eigen::Isometry3d::Identity();   ///< of the transfer frame
  Eigen::Isometry3d T_base_place = Eigen::Isometry3d::Identity();  ///< or half a turn about z
};

/// Bin, post, the container's place and which half of the bin is taken vary.
inline CarryingCell make_carrying_cell(const kinematics::Chain& chain, std::mt19937_64& generator) {
  std::normal_distribution<double> noise(0, 0.02);
  std::uniform_int_distribution<int> coin(0, 1);
  const auto upright_at = [](double x, double y, double z, double yaw_rad) {
    return Eigen::Isometry3d(Eigen::Translation3d(x, y, z) *
                             Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  };
  CarryingCell cell;
  const auto add = [&](const Eigen::Isometry3d& T_base_box, const Eigen::Vector3d& size) {
    auto& objects = cell.surroundings.scene.objects;
    objects.push_back({"box" + std::to_string(objects.size()), BoxShape{size}, T_base_box});
  };
  const Eigen::Vector3d container(0.11, 0.09, 0.1);
  constexpr double kHalfLength = 0.15, kHalfWidth = 0.075, kWall = 0.024, kHeight = 0.18;
  const double bin_x = 0.5 + noise(generator), bin_y = -0.3 + noise(generator);
  const Eigen::Isometry3d T_base_bin = upright_at(bin_x, bin_y, 0, 2 * noise(generator));
  const auto add_in_bin = [&](double x, double y, double height, const Eigen::Vector2d& size) {
    add(T_base_bin * Eigen::Translation3d(x, y, height / 2), {size.x(), size.y(), height});
  };
  add(upright_at(0.55, 0, -0.03, 0), {0.7, 1.4, 0.04});  // table
  for (const double side : {-1.0, 1.0}) {
    add_in_bin(0, side * (kHalfWidth + kWall / 2), kHeight, {2 * (kHalfLength + kWall), kWall});
    add_in_bin(side * (kHalfLength + kWall / 2), 0, kHeight, {kWall, 2 * kHalfWidth});
  }
  const double taken = (coin(generator) == 1 ? 0.5 : -0.5) * kHalfLength;
  add_in_bin(taken, 0, 0.14, container.head<2>());
  const double post_x = 0.55 + noise(generator), post_y = noise(generator);
  add(upright_at(post_x, post_y, 0.35, 2 * noise(generator)), {0.08, 0.08, 0.7});

  constexpr double kPalm_m = 0.145;  // above the table
  const double pick_x = 0.5 + noise(generator), pick_y = 0.3 + noise(generator);
  const Eigen::AngleAxisd down(std::numbers::pi, Eigen::Vector3d::UnitX());
  cell.T_base_pick = upright_at(pick_x, pick_y, kPalm_m, 3 * noise(generator)) * down;
  cell.T_base_place = T_base_bin * Eigen::Translation3d(-taken, 0, kPalm_m) * down;
  cell.upright = planning::upright_region(0.15);

  AttachedObject held;
  held.name = "container";
  held.link = chain.tip_link();
  held.shape = BoxShape{container};
  held.T_link_object = chain.T_tip_transfer() * Eigen::Translation3d(0, 0, 0.07);
  cell.surroundings.attached.push_back(held);
  return cell;
}

}  // namespace kinship::test
