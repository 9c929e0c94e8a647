#pragma once

#include <Eigen/Geometry>
#include <random>

#include "proto/types/scene.hpp"

namespace kinship::experiments {

/// One instance of the pick-and-place task, whatever robot does it: a box is taken from a table
/// and put into a compartment of a shelf.
///
/// The task frame belongs to the station: z = 0 is the top of the table, x points from the robot's
/// side towards the shelf. Poses of the transfer frame have z = approach direction.
struct ShelfScene {
  Scene scene;
  Eigen::Isometry3d T_task_pick = Eigen::Isometry3d::Identity();   ///< of the transfer frame
  Eigen::Isometry3d T_task_place = Eigen::Isometry3d::Identity();  ///< of the transfer frame
};

/// Draws an instance: the shelf, the box to fetch and everything beside them stand about 2 cm and
/// a few degrees from their nominal places; one of the four compartments is the goal, one or two
/// others are occupied. Equal generator, equal scene.
ShelfScene draw_shelf_scene(std::mt19937_64& generator);

/// The held box, and its pose in the transfer frame.
BoxShape held_box();
Eigen::Isometry3d T_transfer_box();

/// Name of the table top among the scene's objects; a robot stands on it.
inline constexpr const char* kTableName = "table";

}  // namespace kinship::experiments
