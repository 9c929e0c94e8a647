#include "client/planner/problem_lines.hpp"

#include <string>

#include "proto/files/lines.hpp"
#include "proto/json/problem_json.hpp"

namespace kinship::planner {

std::vector<ProblemLine> read_problem_lines(std::istream& stream) {
  std::vector<ProblemLine> lines;
  files::for_each_line(stream, "problems", [&](const files::Line& line) {
    lines.push_back({line.number, line.text ? json::problem_from_json(*line.text)
                                            : Result<Problem>(line.text.error())});
    return true;
  });
  return lines;
}

ProblemResult broken_line_result(std::size_t number, const Error& error) {
  ProblemResult result;
  result.name = "line " + std::to_string(number);
  result.reason = result.name + ": " + error.message;
  result.not_planned = NotPlanned::Unreadable;
  return result;
}

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
