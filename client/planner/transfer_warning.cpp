#include "client/planner/transfer_warning.hpp"

namespace kinship::planner {
namespace {

/// The first pose of the transfer frame that a problem gives, as text; empty if it gives none.
std::string pose_of(const Problem& problem) {
  if (problem.T_task_start)
    return "start";
  return problem.T_task_goal ? "goal" : "";
}

}  // namespace

std::string transfer_warning(const std::vector<ProblemLine>& lines, const std::string& tip_link) {
  for (const ProblemLine& line : lines) {
    const std::string pose = line.problem ? pose_of(*line.problem) : "";
    if (!pose.empty())
      return "warning: the " + pose + " of '" + line.problem->name +
             "' is a pose, and no transfer frame was given: poses are taken for those of the tip "
             "link '" +
             tip_link +
             "'; if the hand has a tool, pass --transfer \"x y z qx qy qz qw\", its pose "
             "in the tip link (\"0 0 0 0 0 0 1\": there is none)\n";
  }
  return "";
}

}  // namespace kinship::planner
