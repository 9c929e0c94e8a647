#pragma once

#include "proto/codec/arena.hpp"
#include "proto/codec/reader.hpp"
#include "proto/idl/fetch.h"
#include "proto/types/rules.hpp"
#include "proto/types/selection.hpp"

/// A selection as a member of messages, which may lack it: all experience.
namespace kinship::codec {

using SelectionMember = decltype(kinship_wire_FetchRequest::selection);

Rules& check_selection(const Selection& selection, Rules& rules);
void write_part(const Selection& selection, Arena& arena, SelectionMember& wire);
void read_part(const SelectionMember& wire, Reader& reader, Selection& selection);

}  // namespace kinship::codec
