#pragma once

#include <string>
#include <string_view>

#include "proto/types/result.hpp"

namespace kinship::guided {

enum class PlannerKind {
  ByProblem,  ///< BiRRT, or CBiRRT2 under a constraint
  Birrt,
  Cbirrt2,
  Roadmap,
  Ompl
};

/// Which planner answers the problems of a run.
struct PlannerChoice {
  PlannerKind kind = PlannerKind::ByProblem;
  std::string ompl_planner = {};  ///< of planning::ompl_planner_names(); with Ompl only
};

/// "birrt", "cbirrt2", "roadmap" or "ompl:NAME".
/// \return InvalidInput that shows the text and what can be said.
Result<PlannerChoice> parse_planner(std::string_view text);

/// The planner of one problem; never ByProblem. CBiRRT2 without a constraint is BiRRT.
/// \return InvalidInput that names planners which can do what this one cannot.
Result<PlannerChoice> planner_for(const PlannerChoice& wanted, bool is_constrained);

/// As results and reports name it: "BiRRT", "CBiRRT2", "Repetition Roadmap", "OMPL RRTConnect".
std::string name_of(const PlannerChoice& planner);

}  // namespace kinship::guided
