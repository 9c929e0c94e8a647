#pragma once

#include "proto/codec/arena.hpp"
#include "proto/codec/reader.hpp"
#include "proto/idl/report.h"
#include "proto/types/recorded_scene.hpp"

/// Recorded scenes, parts of a report; for the sources of this folder only.
namespace kinship::codec {

void write_scene(const RecordedScene& scene, Arena& arena, kinship_wire_RecordedScene& wire);

/// Counts and bytes are checked before memory is allocated; names, sizes and bounds as in
/// check_scene().
RecordedScene read_scene(const kinship_wire_RecordedScene& wire, Reader& reader);

/// Bytes of a message's scene that count against kMaxSceneBytes, computed from its lengths.
std::size_t scene_bytes(const kinship_wire_RecordedScene& wire);

}  // namespace kinship::codec
