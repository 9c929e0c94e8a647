#pragma once

#include "proto/codec/arena.hpp"
#include "proto/codec/reader.hpp"
#include "proto/idl/fetch.h"
#include "proto/types/distribution.hpp"

/// The part of the fetch codec that handles distributions.
namespace kinship::codec {

/// \param distribution  checked by validate(const Distribution&).
void write_part(const Distribution& distribution, Arena& arena, kinship_wire_Distribution& wire);

/// Broken rules are recorded in the reader.
void read_part(const kinship_wire_Distribution& wire, Reader& reader, Distribution& distribution);

}  // namespace kinship::codec
