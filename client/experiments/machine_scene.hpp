#pragma once

#include <random>

#include "client/experiments/station_scene.hpp"

namespace kinship::experiments {

/// Draws an instance of loading a machine: a part is taken from a pallet beside the robot and put
/// onto a fixture behind the door of a machine.
///
/// Machine and pallet stand about 2 cm and 3 degrees from their nominal places, the part anywhere
/// on the pallet, the fixture about 1.5 cm from its place in the machine. Equal generator, equal
/// scene.
StationScene draw_machine_scene(std::mt19937_64& generator);

}  // namespace kinship::experiments
