#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "proto/types/mesh_solids.hpp"

namespace kinship::store {

/// \return bytes that keep every number, poses as 7 numbers; empty without solids.
std::vector<std::uint8_t> encode_mesh_solids(const MeshSolids& mesh_solids);

/// \return the solids, or nothing if the bytes are no solids that keep the rules.
std::optional<MeshSolids> decode_mesh_solids(std::span<const std::uint8_t> bytes);

}  // namespace kinship::store
