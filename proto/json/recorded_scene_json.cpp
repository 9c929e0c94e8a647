#include "proto/json/recorded_scene_json.hpp"

#include <nlohmann/json.hpp>

#include "proto/json/name_pairs_json.hpp"
#include "proto/json/scene_json.hpp"
#include "proto/json/task_space_region_json.hpp"
#include "proto/types/limits.hpp"

namespace kinship::json {
namespace {

HeldObject read_held(const Reader& reader) {
  reader.allow_only({"name", "shape", "T_transfer_object", "approximate"});
  const auto approximate = reader.find("approximate");
  return {read_name(reader.at("name")), read_shape(reader.at("shape")),
          reader.at("T_transfer_object").pose(), approximate && approximate->boolean()};
}

}  // namespace

OrderedJson recorded_scene_object(const RecordedScene& scene) {
  OrderedJson document = scene_object({scene.objects});
  OrderedJson held = OrderedJson::array();
  for (const HeldObject& each : scene.held) {
    OrderedJson entry;
    entry["name"] = each.name;
    entry["shape"] = shape_object(each.shape);
    entry["T_transfer_object"] = pose_list(each.T_transfer_object);
    if (each.approximate)
      entry["approximate"] = true;
    held.push_back(std::move(entry));
  }
  document["held"] = std::move(held);
  document["allowed_collisions"] = pair_list(scene.allowed_collisions);
  if (scene.constraint)
    document["constraint"] = region_object(*scene.constraint);
  return document;
}

RecordedScene read_recorded_scene(const Reader& reader) {
  reader.allow_only({"boxes", "cylinders", "spheres", "capsules", "meshes", "clouds", "held",
                     "allowed_collisions", "constraint"});
  RecordedScene scene;
  for (const char* key : {"meshes", "clouds"})
    if (const auto files = reader.find(key); files && !files->elements(kMaxHeldObjects).empty())
      files->refuse("only shapes are kept here");
  scene.objects = read_solids(reader).objects;
  if (const auto held = reader.find("held"))
    for (const Reader& each : held->elements(kMaxHeldObjects))
      scene.held.push_back(read_held(each));
  if (const auto allowed = reader.find("allowed_collisions"))
    scene.allowed_collisions = read_pairs(*allowed);
  if (const auto constraint = reader.find("constraint"))
    scene.constraint = read_region(*constraint);
  return scene;
}

}  // namespace kinship::json
