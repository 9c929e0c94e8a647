#pragma once

#include <Eigen/Geometry>
#include <random>
#include <string>

#include "client/experiments/studies/instance_draws.hpp"
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

/// Draws an instance of loading a machine: a part is taken from a pallet beside the robot and put
/// onto a fixture behind the door of a machine.
///
/// Machine and pallet stand about 2 cm and 3 degrees from their nominal places, the part anywhere
/// on the pallet, the fixture about 1.5 cm from its place in the machine. Equal generator, equal
/// scene.
StationScene draw_machine_scene(std::mt19937_64& generator);

/// Draws an instance of filling a shelf: a box is taken from a table and put into a compartment of
/// a shelf.
///
/// The shelf, the box to fetch and everything beside them stand about 2 cm and a few degrees from
/// their nominal places; one of the four compartments is the goal, one or two others are occupied.
/// Equal generator, equal scene.
StationScene draw_shelf_scene(std::mt19937_64& generator);

/// The held box, and its pose in the transfer frame.
BoxShape held_box();
Eigen::Isometry3d T_transfer_box();

}  // namespace kinship::experiments
