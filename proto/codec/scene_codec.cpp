#include "proto/codec/scene_codec.hpp"

#include "proto/codec/fields.hpp"
#include "proto/types/limits.hpp"

namespace kinship::codec {
namespace {

void write_solid(const std::string& name, const Shape& shape, const Eigen::Isometry3d& T,
                 bool approximate, Arena& arena, kinship_wire_SceneSolid& wire) {
  wire.name = arena.text(name);
  write_shape(shape, wire);
  write_pose(T, wire.pose);
  wire.approximate = approximate;
}

/// name, shape and pose of a solid, as SceneObject and HeldObject begin.
template <typename Thing>
Thing read_solid(const kinship_wire_SceneSolid& wire, Reader& reader) {
  std::string name = read_text(wire.name);
  Shape shape = read_shape("scene: shape", wire, reader);
  const Eigen::Isometry3d T = reader.pose("scene: '" + name + "'", wire.pose);
  return {std::move(name), shape, T, wire.approximate};
}

}  // namespace

static void write_part(const SceneObject& object, Arena& arena, kinship_wire_SceneSolid& wire) {
  write_solid(object.name, object.shape, object.T_task_object, object.approximate, arena, wire);
}

static void write_part(const HeldObject& held, Arena& arena, kinship_wire_SceneSolid& wire) {
  write_solid(held.name, held.shape, held.T_transfer_object, held.approximate, arena, wire);
}

template <typename Thing>
static void read_part(const kinship_wire_SceneSolid& wire, Reader& reader, Thing& thing) {
  thing = read_solid<Thing>(wire, reader);
}

static void write_part(const TaskSpaceRegion& region, Arena& /*arena*/,
                       kinship_wire_TaskSpaceRegion& wire) {
  write_pose(region.T_task_region, wire.T_task_region);
  write_pose(region.T_region_end, wire.T_region_end);
  std::copy_n(region.bounds.data(), region.bounds.size(), std::begin(wire.bounds));
}

static void read_part(const kinship_wire_TaskSpaceRegion& wire, Reader& reader,
                      TaskSpaceRegion& region) {
  region.T_task_region = reader.pose("scene: constraint: T0_w", wire.T_task_region);
  region.T_region_end = reader.pose("scene: constraint: Tw_e", wire.T_region_end);
  region.bounds = Eigen::Map<const Eigen::Matrix<double, 2, 6>>(std::data(wire.bounds));
}

void write_part(const RecordedScene& scene, Arena& arena, kinship_wire_RecordedScene& wire) {
  write_value(scene.objects, {}, arena, wire.objects);
  write_value(scene.held, {}, arena, wire.held);
  write_value(scene.allowed_collisions, {}, arena, wire.allowed_collisions);
  write_value(scene.constraint, {}, arena, wire.constraint);
}

void read_part(const kinship_wire_RecordedScene& wire, Reader& reader, RecordedScene& scene) {
  reader.rules.at_most("scene (bytes)", scene_bytes(wire), kMaxSceneBytes);
  if (reader.rules.broken())
    return;
  scene.objects = read_value<std::vector<SceneObject>>({"scene: objects"}, wire.objects,
                                                       {.limit = kMaxSceneObjects}, reader);
  scene.held = read_value<std::vector<HeldObject>>({"scene: held things"}, wire.held,
                                                   {.limit = kMaxHeldObjects}, reader);
  scene.allowed_collisions = read_value<std::vector<NamePair>>(
      {"scene: allowed pairs"}, wire.allowed_collisions, {.limit = kMaxAllowedPairs}, reader);
  scene.constraint =
      read_value<std::optional<TaskSpaceRegion>>({"constraint"}, wire.constraint, {}, reader);
}

std::size_t scene_bytes(const kinship_wire_RecordedScene& wire) {
  // As the contract says.
  constexpr std::size_t kSolidBytes = 96, kPairBytes = 16, kConstraintBytes = 216;
  std::size_t bytes = kSolidBytes * (elements(wire.objects).size() + elements(wire.held).size()) +
                      kPairBytes * elements(wire.allowed_collisions).size() +
                      kConstraintBytes * elements(wire.constraint).size();
  for (const kinship_wire_SceneSolid& solid : elements(wire.objects))
    bytes += text_bytes(solid.name);
  for (const kinship_wire_SceneSolid& solid : elements(wire.held))
    bytes += text_bytes(solid.name);
  for (const kinship_wire_SolidPair& pair : elements(wire.allowed_collisions))
    bytes += text_bytes(pair.first) + text_bytes(pair.second);
  return bytes;
}

}  // namespace kinship::codec
