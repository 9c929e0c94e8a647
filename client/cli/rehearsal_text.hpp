#pragma once

#include <iosfwd>
#include <optional>

#include "proto/types/rehearsal.hpp"

namespace kinship::cli {

/// What a server rehearsed, for people: on what, and a table of what each guide cost, in collision
/// checks. "UNIFORM / GUIDED" is the mean without a guide over that with it: above 1 it saves.
/// \param rehearsal  missing: nothing is known yet, and it is said what begins it.
void print_rehearsal(const std::optional<Rehearsal>& rehearsal, std::ostream& out);

}  // namespace kinship::cli
