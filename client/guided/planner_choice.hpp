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
  RrtConnect,  ///< whole lines at once; not under a constraint
  Ompl
};

/// The planner of a run's problems.
struct PlannerChoice {
  PlannerKind kind = PlannerKind::ByProblem;
  std::string ompl_planner = {};  ///< of ompl_planners::ompl_planner_names(); with Ompl only
};

/// "birrt", "cbirrt2", "roadmap", "rrtconnect" or "ompl:NAME".
/// \return InvalidInput that shows the text and the valid names.
Result<PlannerChoice> parse_planner(std::string_view text);

/// The planner of one problem; never ByProblem. CBiRRT2 without a constraint is BiRRT.
/// \return InvalidInput that names the planners able to plan the problem, if this one is not.
Result<PlannerChoice> planner_for(const PlannerChoice& wanted, bool is_constrained);

/// Its name in results and reports: "BiRRT", "CBiRRT2", "Repetition Roadmap",
/// "RRT-Connect", "OMPL RRTConnect".
std::string name_of(const PlannerChoice& planner);

}  // namespace kinship::guided
