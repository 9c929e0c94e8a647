#include "client/experiments/result_file.hpp"

#include <string>

#include "proto/files/lines.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {

std::vector<ProblemResult> read_results(const std::filesystem::path& file) {
  std::ifstream stream = files::open_input(file);
  std::vector<ProblemResult> results;
  files::for_each_line(stream, file.string(), [&](const files::Line& line) {
    Result<ProblemResult> result =
        line.text ? json::problem_result_from_json(*line.text) : line.text.error();
    if (!result)
      throw Failure(result.error().code, file.string() + " line " + std::to_string(line.number) +
                                             ": " + result.error().message);
    results.push_back(*std::move(result));
    return true;
  });
  return results;
}

}  // namespace kinship::experiments
