#pragma once

#include "proto/codec/arena.hpp"
#include "proto/codec/reader.hpp"
#include "proto/idl/fetch.h"
#include "proto/types/recall_library.hpp"

/// A library of paths to recall as part of a reply. For the sources of this folder only.
namespace kinship::codec {

void write_part(const RecallLibrary& library, Arena& arena, kinship_wire_RecallLibrary& wire);

/// Counts are checked before anything is allocated; validate() tests the rest.
void read_part(const kinship_wire_RecallLibrary& wire, Reader& reader, RecallLibrary& library);

}  // namespace kinship::codec
