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

}  // namespace kinship::planner
