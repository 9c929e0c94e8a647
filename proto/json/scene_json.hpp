#pragma once

#include "proto/json/reader.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/scene.hpp"

/// Scenes and attached objects, parts of a problem; for this library's sources only.
namespace kinship::json {

OrderedJson scene_object(const Scene& scene);
OrderedJson attached_object(const AttachedObject& attached);

OrderedJson shape_object(const Shape& shape);

/// Absent lists are empty. Meshes are given by file name.
Scene read_scene(const Reader& reader);
/// The solids, without meshes, of a JSON object that may have other members too.
Scene read_solids(const Reader& reader);
AttachedObject read_attached(const Reader& reader);
/// Refuses a mesh.
Shape read_shape(const Reader& reader);

/// A name of 1 to kMaxLinkNameBytes bytes.
std::string read_name(const Reader& reader);

}  // namespace kinship::json
