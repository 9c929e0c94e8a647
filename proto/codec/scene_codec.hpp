#pragma once

#include "proto/codec/arena.hpp"
#include "proto/codec/reader.hpp"
#include "proto/idl/report.h"
#include "proto/types/recorded_scene.hpp"

/// Shapes, and recorded scenes, parts of a report; for the sources of this folder only.
namespace kinship::codec {

/// \param wire  any solid of the IDL.
template <typename Wire>
void write_shape(const Shape& shape, Wire& wire) {
  const ShapeNumbers numbers = to_numbers(shape);
  wire.shape = static_cast<std::uint32_t>(numbers.kind);
  std::copy(numbers.sizes.begin(), numbers.sizes.end(), std::begin(wire.size));
}

template <typename Wire>
Shape read_shape(std::string_view what, const Wire& wire, Reader& reader) {
  constexpr std::uint32_t kLast = std::variant_size_v<Shape> - 1;
  const std::uint32_t kind = reader.enumerator(what, wire.shape, kLast);
  return to_shape({kind, {wire.size[0], wire.size[1], wire.size[2]}});
}

void write_part(const RecordedScene& scene, Arena& arena, kinship_wire_RecordedScene& wire);

/// Counts and bytes are checked before memory is allocated; names, sizes and bounds as in
/// check_scene().
void read_part(const kinship_wire_RecordedScene& wire, Reader& reader, RecordedScene& scene);

/// Bytes of a message's scene that count against kMaxSceneBytes, computed from its lengths.
std::size_t scene_bytes(const kinship_wire_RecordedScene& wire);

}  // namespace kinship::codec
