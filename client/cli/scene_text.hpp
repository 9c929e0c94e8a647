#pragma once

#include <iosfwd>
#include <string>

#include "proto/types/recorded_scene.hpp"

/// A recorded scene for people.
namespace kinship::cli {

/// "stays within a task space region: z 0.2..0.4 m, roll -0.15..0.15 rad": the coordinates that
/// have a bound; "inf" where there is none on one side.
std::string region_text(const TaskSpaceRegion& region);

/// The objects of a scene and its constraint; one line each, values from the 13th column on.
void print_scene(const RecordedScene& scene, std::ostream& out);

}  // namespace kinship::cli
