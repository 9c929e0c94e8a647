#pragma once

#include <iosfwd>

#include "client/experiments/comparison.hpp"

namespace kinship::experiments {

/// The comparison as an aligned table for people, with what its figures mean below.
void write_table(const Comparison& comparison, std::ostream& out);

/// The comparison as one JSON document on one line; what is infinite or undefined is null.
void write_json(const Comparison& comparison, std::ostream& out);

}  // namespace kinship::experiments
