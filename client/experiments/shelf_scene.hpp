#pragma once

#include <random>

#include "client/experiments/station_scene.hpp"

namespace kinship::experiments {

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
