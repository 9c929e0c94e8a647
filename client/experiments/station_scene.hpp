#pragma once

#include <Eigen/Geometry>
#include <random>
#include <string>

#include "client/experiments/studies/instance_random.hpp"
#include "proto/types/scene.hpp"

namespace kinship::experiments {

/// One instance of a pick-and-place task, whatever robot does it: something is held over one place
/// and is to be held at another.
///
/// The task frame belongs to the station: z = 0 is the top of the table, x points from the robot's
/// side to what it reaches into. Poses of the transfer frame have z = approach direction.
struct StationScene {
  Scene scene;
  Eigen::Isometry3d T_task_pick = Eigen::Isometry3d::Identity();   ///< of the transfer frame
  Eigen::Isometry3d T_task_place = Eigen::Isometry3d::Identity();  ///< of the transfer frame
  std::string held_name;
  BoxShape held;
  Eigen::Isometry3d T_transfer_held = Eigen::Isometry3d::Identity();
};

/// Name of the table top among a scene's objects; a robot stands on it.
inline constexpr const char* kTableName = "table";

/// A pose turned about the vertical alone, m.
Eigen::Isometry3d upright(double x, double y, double z, double yaw_rad = 0);

/// Upright, with normal noise of `deviation_m` in x and y and of `turn_rad` about the vertical.
Eigen::Isometry3d displaced(const Eigen::Vector3d& p, double deviation_m, double turn_rad,
                            Noise& noise);

/// How the transfer frame is turned when the hand looks down; its fingers close along y.
Eigen::Isometry3d looking_down();

void add_box(Scene& scene, std::string name, const Eigen::Vector3d& size,
             const Eigen::Isometry3d& T_task_object);

/// The table top that a robot stands on: `middle` and `size` in x and y, m.
void add_table_top(Scene& scene, const Eigen::Vector2d& middle, const Eigen::Vector2d& size);

}  // namespace kinship::experiments
