#pragma once

#include <string>

#include "client/guided/plan_problem.hpp"
#include "client/guided/plan_settings.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/problem.hpp"

namespace kinship::guided {

/// Origin of a report: robot, machine and task.
struct Reporter {
  Digest robot;
  std::string machine;
  std::string task;
};

/// The attempt that reports a planned problem to the server, under a new report UUID.
Attempt make_attempt(const Reporter& reporter, const Problem& problem,
                     const PlannedProblem& planned, const PlanSettings& settings);

}  // namespace kinship::guided
