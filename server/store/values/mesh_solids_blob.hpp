#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "proto/types/robot_description.hpp"

namespace kinship::store {

/// A robot's geometry beside its URDF, as in column mesh_solids.
struct StoredGeometry {
  MeshSolids solids;
  std::vector<LinkMesh> meshes;
};

/// \return bytes that keep every number, poses as 7 numbers; empty without solids and meshes. In
///         format 1 without meshes, for which every release reads.
std::vector<std::uint8_t> encode_geometry(const RobotDescription& description);

/// \return nothing if the bytes are no solids and meshes that keep the rules.
std::optional<StoredGeometry> decode_geometry(std::span<const std::uint8_t> bytes);

}  // namespace kinship::store
