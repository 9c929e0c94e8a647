#pragma once

#include <string>
#include <vector>

#include "client/planner/problem_lines.hpp"

namespace kinship::planner {

/// What a run says whose robot came without a transfer frame: that the poses of its problems are
/// taken for the tip link's, and what to pass. A line, or empty if no problem gives a pose.
std::string transfer_warning(const std::vector<ProblemLine>& lines, const std::string& tip_link);

}  // namespace kinship::planner
