#pragma once

#include <array>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "proto/types/task_space_region.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/kinematics/chain.hpp"
#include "tests/support/carrying_cell.hpp"

/// Kinds of constraint, each a family of cells that vary by their seed. Five are equations, so that
/// the configurations that hold them are a manifold, as OMPL's spaces want it. The base stands at
/// the origin; for arms of about 0.85 m reach.
namespace kinship::bench {

struct ConstrainedCell {
  collision::Surroundings surroundings;
  TaskSpaceRegion region;
  Eigen::Isometry3d T_base_start = Eigen::Isometry3d::Identity();  ///< of the transfer frame
  std::vector<Eigen::Isometry3d> T_base_goals;                     ///< any of them will do
};

inline Eigen::Isometry3d at(double x, double y, double z, double yaw_rad = 0) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z) *
                           Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
}

inline Eigen::AngleAxisd hand_down() { return {std::numbers::pi, Eigen::Vector3d::UnitX()}; }

/// Some displacements of a frame are zero, the others are free.
/// \param fixed  indices of x, y, z, roll, pitch, yaw.
inline TaskSpaceRegion manifold(const Eigen::Isometry3d& T_base_region,
                                const Eigen::Isometry3d& T_region_end,
                                std::initializer_list<Eigen::Index> fixed) {
  TaskSpaceRegion region{T_base_region, T_region_end, {}};
  region.bounds.row(1).setConstant(std::numeric_limits<double>::infinity());
  region.bounds.row(0) = -region.bounds.row(1);
  for (const Eigen::Index coordinate : fixed)
    region.bounds.col(coordinate).setZero();
  return region;
}

inline void add_box(ConstrainedCell& cell, const Eigen::Isometry3d& T_base_box,
                    const Eigen::Vector3d& size) {
  auto& objects = cell.surroundings.scene.objects;
  objects.push_back({"box" + std::to_string(objects.size()), BoxShape{size}, T_base_box});
}

/// \param z_m  of its middle, along the transfer frame's approach.
inline void hold_box(ConstrainedCell& cell, const kinematics::Chain& chain, double z_m,
                     const Eigen::Vector3d& size) {
  AttachedObject held;
  held.name = "held";
  held.link = chain.tip_link();
  held.shape = BoxShape{size};
  held.T_link_object = chain.T_tip_transfer() * Eigen::Translation3d(0, 0, z_m);
  cell.surroundings.attached.push_back(held);
}

/// The hand either way round about the vertical.
inline std::vector<Eigen::Isometry3d> either_way(const Eigen::Isometry3d& T_base_goal) {
  return {T_base_goal, T_base_goal * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ())};
}

/// An open container is carried over a post into a bin: it must not tilt at all.
inline ConstrainedCell upright_cell(const kinematics::Chain& chain, std::mt19937_64& generator) {
  const test::CarryingCell carrying = test::make_carrying_cell(chain, generator);
  return {carrying.surroundings, planning::upright_region(0), carrying.T_base_pick,
          either_way(carrying.T_base_place)};
}

/// The same container may tilt a little: a region, and no manifold.
inline ConstrainedCell tilted_cell(const kinematics::Chain& chain, std::mt19937_64& generator) {
  ConstrainedCell cell = upright_cell(chain, generator);
  cell.region = planning::upright_region(0.15);
  return cell;
}

/// A sponge stays on a table and goes round posts.
inline ConstrainedCell plane_cell(const kinematics::Chain& chain, std::mt19937_64& generator) {
  std::normal_distribution<double> noise(0, 0.03);
  ConstrainedCell cell;
  add_box(cell, at(0.55, 0, -0.03), {0.7, 1.4, 0.04});
  for (const double y : {-0.15, 0.0, 0.15})
    add_box(cell, at(0.5 + (y == 0 ? -0.1 : 0.1) + noise(generator), y + noise(generator), 0.15),
            {0.06, 0.06, 0.32});
  hold_box(cell, chain, 0.07, {0.1, 0.06, 0.06});
  constexpr double kPalm_m = 0.11;  // 1 cm between sponge and table: what it gives way
  cell.region = manifold(at(0, 0, kPalm_m), Eigen::Isometry3d(hand_down()), {2, 3, 4});
  cell.T_base_start =
      at(0.5 + noise(generator), 0.36 + noise(generator), kPalm_m, noise(generator)) * hand_down();
  cell.T_base_goals =
      either_way(at(0.5 + noise(generator), -0.36 + noise(generator), kPalm_m, noise(generator)) *
                 hand_down());
  return cell;
}

/// A nozzle follows a seam past a post, free to turn about itself, below a beam.
inline ConstrainedCell line_cell(const kinematics::Chain& chain, std::mt19937_64& generator) {
  std::normal_distribution<double> noise(0, 0.02);
  ConstrainedCell cell;
  const double x = 0.52 + noise(generator);
  constexpr double kPalm_m = 0.2;
  add_box(cell, at(0.55, 0, -0.03), {0.7, 1.4, 0.04});
  add_box(cell, at(x - 0.2, 2 * noise(generator), 0.2), {0.05, 0.05, 0.44});
  add_box(cell, at(x + 0.15, 2 * noise(generator), 0.25), {0.05, 0.05, 0.5});
  add_box(cell, at(0.25, 2 * noise(generator), 0.9 + noise(generator)), {0.5, 0.06, 0.06});
  hold_box(cell, chain, 0.1, {0.16, 0.03, 0.1});
  cell.region = manifold(at(x, 0, kPalm_m, 2 * noise(generator)), Eigen::Isometry3d(hand_down()),
                         {0, 2, 3, 4});
  const Eigen::Isometry3d& T_base_seam = cell.region.T_task_region;
  cell.T_base_start =
      T_base_seam * at(0, 0.33 + noise(generator), 0, 3 * noise(generator)) * hand_down();
  cell.T_base_goals = either_way(
      T_base_seam * at(0, -0.33 + noise(generator), 0, 3 * noise(generator)) * hand_down());
  return cell;
}

/// A hand opens the door of a cabinet: it keeps hold of the handle, and the leaf moves with it.
inline ConstrainedCell door_cell(const kinematics::Chain& chain, std::mt19937_64& generator) {
  std::normal_distribution<double> noise(0, 0.02);
  std::uniform_real_distribution<double> opened_rad(0.6, 1);
  ConstrainedCell cell;
  constexpr double kWidth = 0.4, kHeight = 0.4, kThick = 0.02, kHandle = 0.36, kPalm = 0.12;
  const double x = 0.7 + noise(generator), y = 0.45 + noise(generator), z = 0.45 + noise(generator);
  // The hinge's z-axis is vertical, its y-axis points along the leaf, away from it.
  const Eigen::Isometry3d T_base_hinge = at(x, y, z, 2 * noise(generator));
  const Eigen::Isometry3d T_base_body = T_base_hinge * at(0.03 + 0.15, -kWidth / 2, 0);
  for (const double side : {-1.0, 1.0}) {
    add_box(cell, T_base_body * at(0, side * (kWidth / 2), 0), {0.3, kThick, kHeight});
    add_box(cell, T_base_body * at(0, 0, side * kHeight / 2), {0.3, kWidth, kThick});
  }
  add_box(cell, at(0.5 + noise(generator), -0.25 + noise(generator), 0.3), {0.08, 0.08, 0.6});
  // The hand looks along the hinge's x-axis, at the handle.
  const Eigen::Isometry3d T_hinge_hand(Eigen::Translation3d(-kPalm, -kHandle, 0) *
                                       Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()));
  AttachedObject leaf;
  leaf.name = "leaf";
  leaf.link = chain.tip_link();
  leaf.shape = BoxShape{{kThick, kWidth, kHeight}};
  leaf.T_link_object = chain.T_tip_transfer() * T_hinge_hand.inverse() * at(0, -kWidth / 2, 0);
  cell.surroundings.attached.push_back(leaf);
  cell.region = manifold(T_base_hinge, T_hinge_hand, {0, 1, 2, 3, 4});
  cell.T_base_start = T_base_hinge * at(0, 0, 0, -0.02) * T_hinge_hand;
  cell.T_base_goals = {T_base_hinge * at(0, 0, 0, -opened_rad(generator)) * T_hinge_hand};
  return cell;
}

/// A container is carried through a window in a wall and must not tilt.
inline ConstrainedCell window_cell(const kinematics::Chain& chain, std::mt19937_64& generator) {
  std::normal_distribution<double> noise(0, 0.02);
  std::uniform_int_distribution<int> coin(0, 1);
  ConstrainedCell cell;
  const double x = 0.48 + noise(generator) / 2, y = noise(generator),
               side = 2 * coin(generator) - 1;
  constexpr double kLow = 0.25, kHigh = 0.85, kHalfWidth = 0.2, kThick = 0.02;
  add_box(cell, at(x, y + kHalfWidth + 0.3, 0.6), {kThick, 0.6, 1.2});
  add_box(cell, at(x, y - kHalfWidth - 0.3, 0.6), {kThick, 0.6, 1.2});
  add_box(cell, at(x, y, kLow / 2), {kThick, 2 * kHalfWidth, kLow});
  add_box(cell, at(x, y, (kHigh + 1.2) / 2), {kThick, 2 * kHalfWidth, 1.2 - kHigh});
  hold_box(cell, chain, 0.07, {0.09, 0.09, 0.1});
  cell.region = planning::upright_region(0);
  cell.T_base_start = at(0.33 + noise(generator), side * 0.3 + noise(generator),
                         0.4 + noise(generator), 3 * noise(generator)) *
                      hand_down();
  cell.T_base_goals = either_way(at(0.64 + noise(generator) / 2, -side * 0.15 + noise(generator),
                                    0.42 + noise(generator), 3 * noise(generator)) *
                                 hand_down());
  return cell;
}

struct ConstraintKind {
  const char* name;
  bool is_manifold;
  ConstrainedCell (*make)(const kinematics::Chain&, std::mt19937_64&);
};

inline constexpr std::array<ConstraintKind, 6> kConstraintKinds = {
    {{"upright", true, upright_cell},
     {"plane", true, plane_cell},
     {"line", true, line_cell},
     {"door", true, door_cell},
     {"window", true, window_cell},
     {"upright to 0.15 rad", false, tilted_cell}}};

}  // namespace kinship::bench
