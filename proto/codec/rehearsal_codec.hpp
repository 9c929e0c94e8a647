#pragma once

#include "proto/codec/arena.hpp"
#include "proto/codec/reader.hpp"
#include "proto/idl/fetch.h"
#include "proto/types/rehearsal.hpp"

/// A rehearsal as part of a reply. For the sources of this folder only.
namespace kinship::codec {

void write_part(const Rehearsal& rehearsal, Arena& arena, kinship_wire_Rehearsal& wire);

/// Broken rules of its fields are recorded in the reader; validate() tests the others.
void read_part(const kinship_wire_Rehearsal& wire, Reader& reader, Rehearsal& rehearsal);

}  // namespace kinship::codec
