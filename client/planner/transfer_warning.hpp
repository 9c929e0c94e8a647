#pragma once

#include <string>
#include <vector>

#include "client/planner/problem_lines.hpp"

namespace kinship::planner {

/// The warning of a run without a transfer frame: poses of its problems are taken for those of the
/// tip link; it names the option to pass. A line, or empty if no problem gives a pose.
std::string transfer_warning(const std::vector<ProblemLine>& lines, const std::string& tip_link);

}  // namespace kinship::planner
