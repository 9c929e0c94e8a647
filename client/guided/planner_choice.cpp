#include "client/guided/planner_choice.hpp"

namespace kinship::guided {

Result<PlannerChoice> parse_planner(std::string_view text) {
  if (text == "birrt")
    return PlannerChoice{PlannerKind::Birrt};
  if (text == "cbirrt2")
    return PlannerChoice{PlannerKind::Cbirrt2};
  if (text == "roadmap")
    return PlannerChoice{PlannerKind::Roadmap};
  if (text == "rrtconnect")
    return PlannerChoice{PlannerKind::RrtConnect};
  return Error{
      ErrorCode::InvalidInput,
      "'" + std::string(text) + "' is no planner here: give birrt, cbirrt2, roadmap or rrtconnect"};
}

Result<PlannerChoice> planner_for(const PlannerChoice& wanted, bool is_constrained) {
  if (wanted.kind == PlannerKind::Other || wanted.kind == PlannerKind::Roadmap)
    return wanted;
  if (!is_constrained)
    return PlannerChoice{wanted.kind == PlannerKind::RrtConnect ? wanted.kind : PlannerKind::Birrt};
  if (wanted.kind == PlannerKind::Birrt || wanted.kind == PlannerKind::RrtConnect)
    return Error{ErrorCode::InvalidInput,
                 std::string("--planner ") +
                     (wanted.kind == PlannerKind::Birrt ? "birrt" : "rrtconnect") +
                     " does not keep to a constraint: use --planner cbirrt2 or roadmap"};
  return PlannerChoice{PlannerKind::Cbirrt2};
}

std::string name_of(const PlannerChoice& planner) {
  switch (planner.kind) {
    case PlannerKind::Birrt:
      return "BiRRT";
    case PlannerKind::Cbirrt2:
      return "CBiRRT2";
    case PlannerKind::Roadmap:
      return "Repetition Roadmap";
    case PlannerKind::RrtConnect:
      return "RRT-Connect";
    case PlannerKind::Other:
      return planner.other_name;
    case PlannerKind::ByProblem:
      break;
  }
  return "";
}

}  // namespace kinship::guided
