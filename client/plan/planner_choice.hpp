#pragma once

#include <string>
#include <string_view>

#include "proto/types/result.hpp"

namespace kinship::plan {

/// Which planner answers the problems of a run.
enum class Planner {
  ByProblem,  ///< BiRRT, or CBiRRT2 under a constraint
  Birrt,
  Cbirrt2
};

/// "birrt" or "cbirrt2".
/// \return InvalidInput that shows the text and what can be said.
Result<Planner> parse_planner(std::string_view text);

/// The planner of one problem; never ByProblem. CBiRRT2 without a constraint is BiRRT.
/// \return InvalidInput that names planners which can do what this one cannot.
Result<Planner> planner_for(Planner wanted, bool is_constrained);

/// As results and reports name it: "BiRRT", "CBiRRT2".
std::string name_of(Planner planner);

}  // namespace kinship::plan
