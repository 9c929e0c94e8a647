#pragma once

#include "proto/json/reader.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/scene.hpp"

/// Scenes and attached objects, parts of a problem; for this library's sources only.
namespace kinship::json {

OrderedJson scene_object(const Scene& scene);
OrderedJson attached_object(const AttachedObject& attached);

/// Absent lists are empty ones. Meshes are refused.
Scene read_scene(const Reader& reader);
AttachedObject read_attached(const Reader& reader);

}  // namespace kinship::json
