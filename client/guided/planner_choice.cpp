#include "client/guided/planner_choice.hpp"

#include <algorithm>
#include <vector>

#include "client/ompl/ompl_planner.hpp"

namespace kinship::guided {
namespace {

constexpr std::string_view kOmpl = "ompl:";

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

Result<PlannerChoice> parse_planner(std::string_view text) {
  if (text == "birrt")
    return PlannerChoice{PlannerKind::Birrt};
  if (text == "cbirrt2")
    return PlannerChoice{PlannerKind::Cbirrt2};
  if (text == "roadmap")
    return PlannerChoice{PlannerKind::Roadmap};
  if (text == "rrtconnect")
    return PlannerChoice{PlannerKind::RrtConnect};
  if (!text.starts_with(kOmpl))
    return Error{ErrorCode::InvalidInput,
                 "'" + std::string(text) +
                     "' is no planner: give birrt, cbirrt2, roadmap, rrtconnect or ompl:NAME"};
  const std::string name(text.substr(kOmpl.size()));
  const std::vector<std::string> names = ompl_planners::ompl_planner_names();
  if (std::ranges::find(names, name) == names.end())
    return Error{
        ErrorCode::InvalidInput,
        "'" + name + "' is no planner of OMPL that can be guided: give one of " + joined(names)};
  return PlannerChoice{PlannerKind::Ompl, name};
}

Result<PlannerChoice> planner_for(const PlannerChoice& wanted, bool is_constrained) {
  if (wanted.kind == PlannerKind::Ompl || wanted.kind == PlannerKind::Roadmap)
    return wanted;
  if (!is_constrained)
    return PlannerChoice{wanted.kind == PlannerKind::RrtConnect ? wanted.kind : PlannerKind::Birrt};
  if (wanted.kind == PlannerKind::Birrt || wanted.kind == PlannerKind::RrtConnect)
    return Error{ErrorCode::InvalidInput,
                 std::string("--planner ") +
                     (wanted.kind == PlannerKind::Birrt ? "birrt" : "rrtconnect") +
                     " does not keep to a constraint: use --planner cbirrt2 or "
                     "ompl:RRTConnect"};
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
    case PlannerKind::Ompl:
      return "OMPL " + planner.ompl_planner;
    case PlannerKind::ByProblem:
      break;
  }
  return "";
}

}  // namespace kinship::guided
