#pragma once

#include "proto/json/reader.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/recorded_scene.hpp"

/// The scene of an attempt: the lists of a problem's scene, `held` and `allowed_collisions`, and
/// the `constraint` if there is one. For this library's sources only.
namespace kinship::json {

OrderedJson recorded_scene_object(const RecordedScene& scene);

/// Absent lists are empty, an absent or null constraint is none. Refuses scenes that break
/// check_scene(); objects are in the order of the lists: boxes, cylinders, spheres, capsules.
RecordedScene read_recorded_scene(const Reader& reader);

}  // namespace kinship::json
