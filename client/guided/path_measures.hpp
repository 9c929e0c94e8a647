#pragma once

#include "client/guided/plan_problem.hpp"
#include "proto/types/problem.hpp"

namespace kinship::guided {

/// Lengths and least clearance of a path, for whom it matters: of all ways of planning alike, in
/// steps of planning::kMeasuredStep. Without a path nothing is changed.
/// \param problem  the one that was planned
void measure_path(const PlannedRobot& robot, const Problem& problem, ProblemResult& result);

}  // namespace kinship::guided
