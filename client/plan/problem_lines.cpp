#include "client/plan/problem_lines.hpp"

#include <istream>
#include <string>

#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"

namespace kinship::plan {

std::vector<ProblemLine> read_problem_lines(std::istream& stream) {
  std::vector<ProblemLine> lines;
  std::string text;
  for (std::size_t number = 1; std::getline(stream, text); ++number)
    if (text.find_first_not_of(" \t\r") != std::string::npos)
      lines.push_back({number, json::problem_from_json(text)});
  if (stream.bad())
    throw Failure(ErrorCode::Storage, "cannot read the problems: a directory, or a disk error");
  return lines;
}

ProblemResult broken_line_result(std::size_t number, const Error& error) {
  ProblemResult result;
  result.name = "line " + std::to_string(number);
  result.reason = result.name + ": " + error.message;
  return result;
}

}  // namespace kinship::plan
