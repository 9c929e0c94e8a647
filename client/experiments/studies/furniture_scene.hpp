#pragma once

#include <Eigen/Geometry>
#include <numbers>
#include <random>

#include "client/experiments/studies/furniture_kinds.hpp"

namespace kinship::experiments {

/// How far furniture stands from its nominal place, uniformly.
inline constexpr double kFurnitureShift_m = 0.4;
inline constexpr double kFurnitureTurn_rad = std::numbers::pi / 3;

/// One instance, whatever robot does it: something that stands anywhere on a board is to be
/// grasped.
///
/// The task frame lies on the floor where the robots stand, x to the furniture, z up.
struct FurnitureScene {
  Scene scene;
  Eigen::Isometry3d T_task_furniture = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_task_grasp = Eigen::Isometry3d::Identity();  ///< of the transfer frame
};

/// Furniture stands up to kFurnitureShift_m and kFurnitureTurn_rad from its nominal place. The
/// thing to grasp is anywhere on one of its boards, others are elsewhere on them; the hand comes
/// forward or downward, as the board says, turned about the vertical. Equal generator, equal scene.
FurnitureScene draw_furniture_scene(FurnitureKind kind, std::mt19937_64& generator);

/// Names of the floor, which robots stand on, and of what is to be grasped.
inline constexpr const char* kFloorName = "floor";
inline constexpr const char* kTargetName = "target";

}  // namespace kinship::experiments
