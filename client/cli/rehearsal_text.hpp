#pragma once

#include <iosfwd>
#include <optional>

#include "proto/types/rehearsal.hpp"

namespace kinship::cli {

/// A server's rehearsal for people: its queries, and a table of each guide's cost in collision
/// checks. "UNIFORM / GUIDED" is the mean without a guide over that with it: above 1 the guide
/// saves.
/// \param rehearsal  missing: there is none yet; the text says how to begin it.
void print_rehearsal(const std::optional<Rehearsal>& rehearsal, std::ostream& out);

}  // namespace kinship::cli
