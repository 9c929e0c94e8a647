#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "client/experiments/comparison.hpp"

namespace kinship::experiments {

/// A line of the table, as text for people; what says nothing is empty.
struct ComparisonRow {
  std::string name, uniform, guided, ratio, p;
};

/// The table's lines below its head. Times have units that suit them.
std::vector<ComparisonRow> comparison_rows(const Comparison& comparison);

/// What the figures mean, and what is to be known of this run; a sentence or two each.
std::vector<std::string> comparison_notes(const Comparison& comparison);

/// What else was compared with uniform planning: a line each.
struct AlsoRow {
  std::string name, solved, checks, checks_ratio, time, time_ratio;
};

/// Means and their ratios. Times have units that suit them.
std::vector<AlsoRow> also_rows(const std::vector<AlsoCompared>& also);

/// The comparison as an aligned table for people, with what its figures mean below, and a second
/// table of what else was compared, if anything was.
void write_table(const Comparison& comparison, const std::vector<AlsoCompared>& also,
                 std::ostream& out);

/// The comparison as one JSON document on one line; what is infinite or undefined is null.
void write_json(const Comparison& comparison, const std::vector<AlsoCompared>& also,
                std::ostream& out);

}  // namespace kinship::experiments
