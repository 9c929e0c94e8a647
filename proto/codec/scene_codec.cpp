#include "proto/codec/scene_codec.hpp"

#include <cstring>

#include "proto/codec/writer.hpp"
#include "proto/types/limits.hpp"

namespace kinship::codec {
namespace {

constexpr std::uint32_t kLastShape = std::variant_size_v<Shape> - 1;

void write_solid(const std::string& name, const Shape& shape, const Eigen::Isometry3d& T,
                 bool approximate, Arena& arena, kinship_wire_SceneSolid& wire) {
  wire.name = arena.text(name);
  const ShapeNumbers numbers = to_numbers(shape);
  wire.shape = static_cast<std::uint32_t>(numbers.kind);
  std::copy(numbers.sizes.begin(), numbers.sizes.end(), std::begin(wire.size));
  const PoseArray pose = to_pose_array(T);
  std::copy(pose.begin(), pose.end(), std::begin(wire.pose));
  wire.approximate = approximate;
}

Shape read_shape(const kinship_wire_SceneSolid& wire, Reader& reader) {
  const std::uint32_t kind = reader.enumerator("scene: shape", wire.shape, kLastShape);
  return to_shape({kind, {wire.size[0], wire.size[1], wire.size[2]}});
}

/// name, shape and pose of a solid, as SceneObject and HeldObject begin.
template <typename Thing>
Thing read_solid(const kinship_wire_SceneSolid& wire, Reader& reader) {
  std::string name = read_text(wire.name);
  Shape shape = read_shape(wire, reader);
  const Eigen::Isometry3d T = reader.pose("scene: '" + name + "'", wire.pose);
  return {std::move(name), shape, T, wire.approximate};
}

void write_region(const TaskSpaceRegion& region, kinship_wire_TaskSpaceRegion& wire) {
  const PoseArray T_task_region = to_pose_array(region.T_task_region);
  const PoseArray T_region_end = to_pose_array(region.T_region_end);
  std::copy(T_task_region.begin(), T_task_region.end(), std::begin(wire.T_task_region));
  std::copy(T_region_end.begin(), T_region_end.end(), std::begin(wire.T_region_end));
  std::copy_n(region.bounds.data(), region.bounds.size(), std::begin(wire.bounds));
}

TaskSpaceRegion read_region(const kinship_wire_TaskSpaceRegion& wire, Reader& reader) {
  TaskSpaceRegion region;
  region.T_task_region = reader.pose("scene: constraint: T0_w", wire.T_task_region);
  region.T_region_end = reader.pose("scene: constraint: Tw_e", wire.T_region_end);
  region.bounds = Eigen::Map<const Eigen::Matrix<double, 2, 6>>(std::data(wire.bounds));
  return region;
}

std::size_t length(const char* text) { return text == nullptr ? 0 : std::strlen(text); }

}  // namespace

void write_scene(const RecordedScene& scene, Arena& arena, kinship_wire_RecordedScene& wire) {
  arena.resize(wire.objects, scene.objects.size());
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    write_solid(object.name, object.shape, object.T_task_object, object.approximate, arena,
                wire.objects._buffer[i]);
  }
  arena.resize(wire.held, scene.held.size());
  for (std::size_t i = 0; i < scene.held.size(); ++i) {
    const HeldObject& held = scene.held[i];
    write_solid(held.name, held.shape, held.T_transfer_object, held.approximate, arena,
                wire.held._buffer[i]);
  }
  arena.resize(wire.allowed_collisions, scene.allowed_collisions.size());
  for (std::size_t i = 0; i < scene.allowed_collisions.size(); ++i) {
    const auto& [first, second] = scene.allowed_collisions[i];
    wire.allowed_collisions._buffer[i] = {arena.text(first), arena.text(second)};
  }
  if (scene.constraint) {
    arena.resize(wire.constraint, 1);
    write_region(*scene.constraint, wire.constraint._buffer[0]);
  }
}

RecordedScene read_scene(const kinship_wire_RecordedScene& wire, Reader& reader) {
  RecordedScene scene;
  reader.rules.at_most("scene: objects", elements(wire.objects).size(), kMaxSceneObjects)
      .at_most("scene: held things", elements(wire.held).size(), kMaxHeldObjects)
      .at_most("scene: allowed pairs", elements(wire.allowed_collisions).size(), kMaxAllowedPairs)
      .at_most("scene (bytes)", scene_bytes(wire), kMaxSceneBytes);
  if (reader.rules.broken())
    return scene;
  for (const kinship_wire_SceneSolid& solid : elements(wire.objects))
    scene.objects.push_back(read_solid<SceneObject>(solid, reader));
  for (const kinship_wire_SceneSolid& solid : elements(wire.held))
    scene.held.push_back(read_solid<HeldObject>(solid, reader));
  for (const kinship_wire_SolidPair& pair : elements(wire.allowed_collisions))
    scene.allowed_collisions.emplace_back(read_text(pair.first), read_text(pair.second));
  if (const auto constraint = elements(wire.constraint); !constraint.empty())
    scene.constraint = read_region(constraint[0], reader);
  return scene;
}

std::size_t scene_bytes(const kinship_wire_RecordedScene& wire) {
  // As the contract says.
  constexpr std::size_t kSolidBytes = 96, kPairBytes = 16, kConstraintBytes = 216;
  std::size_t bytes = kSolidBytes * (elements(wire.objects).size() + elements(wire.held).size()) +
                      kPairBytes * elements(wire.allowed_collisions).size() +
                      kConstraintBytes * elements(wire.constraint).size();
  for (const kinship_wire_SceneSolid& solid : elements(wire.objects))
    bytes += length(solid.name);
  for (const kinship_wire_SceneSolid& solid : elements(wire.held))
    bytes += length(solid.name);
  for (const kinship_wire_SolidPair& pair : elements(wire.allowed_collisions))
    bytes += length(pair.first) + length(pair.second);
  return bytes;
}

}  // namespace kinship::codec
