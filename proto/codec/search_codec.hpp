#pragma once

#include <cstddef>

#include "proto/codec/arena.hpp"
#include "proto/codec/reader.hpp"
#include "proto/idl/report.h"
#include "proto/types/search_record.hpp"

/// Search records, parts of a report; for the sources of this folder only.
namespace kinship::codec {

void write_part(const SearchRecord& search, Arena& arena, kinship_wire_SearchRecord& wire);

/// Counts and bytes are checked before memory is allocated; the rest as in check_search().
void read_part(const kinship_wire_SearchRecord& wire, Reader& reader, SearchRecord& search);

/// Bytes of a message's record that count against kMaxSearchBytes, computed from its lengths.
std::size_t search_bytes(const kinship_wire_SearchRecord& wire);

}  // namespace kinship::codec
