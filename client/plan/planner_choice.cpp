#include "client/plan/planner_choice.hpp"

namespace kinship::plan {

Result<Planner> parse_planner(std::string_view text) {
  if (text == "birrt")
    return Planner::Birrt;
  if (text == "cbirrt2")
    return Planner::Cbirrt2;
  return Error{ErrorCode::InvalidInput,
               "'" + std::string(text) + "' is no planner: give birrt or cbirrt2"};
}

Result<Planner> planner_for(Planner wanted, bool is_constrained) {
  if (!is_constrained)
    return Planner::Birrt;
  if (wanted == Planner::Birrt)
    return Error{ErrorCode::InvalidInput,
                 "--planner birrt does not keep to a constraint: use --planner cbirrt2"};
  return Planner::Cbirrt2;
}

std::string name_of(Planner planner) {
  switch (planner) {
    case Planner::Birrt:
      return "BiRRT";
    case Planner::Cbirrt2:
      return "CBiRRT2";
    case Planner::ByProblem:
      break;
  }
  return "";
}

}  // namespace kinship::plan
