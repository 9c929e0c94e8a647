#pragma once

#include <string>

#include "client/guided/plan_problem.hpp"
#include "client/guided/plan_settings.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/problem.hpp"

namespace kinship::guided {

/// Origin of a report.
struct Reporter {
  const PlannedRobot& robot;
  std::string machine;
  std::string task;
};

/// The attempt that reports a planned problem to the server, under a new report UUID. A path that
/// was not measured yet is, in some milliseconds (path_measures.hpp).
Attempt make_attempt(const Reporter& reporter, const Problem& problem,
                     const PlannedProblem& planned, const PlanSettings& settings);

}  // namespace kinship::guided
