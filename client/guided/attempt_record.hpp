#pragma once

#include <string>

#include "client/guided/plan_problem.hpp"
#include "client/guided/plan_settings.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/problem.hpp"

namespace kinship::guided {

/// Who reports, and for what.
struct Reporter {
  Digest robot;
  std::string machine;
  std::string task;
};

/// What the server is told about a planned problem, under a new report UUID.
Attempt make_attempt(const Reporter& reporter, const Problem& problem,
                     const PlannedProblem& planned, const PlanSettings& settings);

}  // namespace kinship::guided
