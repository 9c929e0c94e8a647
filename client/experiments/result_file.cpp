#include "client/experiments/result_file.hpp"

#include <fstream>
#include <string>

#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {

std::vector<ProblemResult> read_results(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream)
    throw Failure(ErrorCode::NotFound, "cannot read '" + file.string() + "'");
  std::vector<ProblemResult> results;
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    if (line.empty())
      continue;
    Result<ProblemResult> result = json::problem_result_from_json(line);
    if (!result)
      throw Failure(result.error().code, file.string() + " line " + std::to_string(number) + ": " +
                                             result.error().message);
    results.push_back(*std::move(result));
  }
  return results;
}

}  // namespace kinship::experiments
