#include "client/results/page/run_files.hpp"

#include <iterator>
#include <utility>

#include "proto/files/lines.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::results {
namespace {

/// Hands over what `read` makes of each line.
template <typename Read, typename Use>
void read_each_line(const std::filesystem::path& file, Read read, Use use) {
  std::ifstream stream = files::open_input(file);
  files::for_each_line(stream, file.string(), [&](const files::Line& line) {
    auto value = line.text ? read(*line.text) : decltype(read(*line.text))(line.text.error());
    if (!value)
      throw Failure(value.error().code, file.string() + " line " + std::to_string(line.number) +
                                            ": " + value.error().message);
    use(*std::move(value));
    return true;
  });
}

}  // namespace

std::map<std::string, Problem> read_problems(const std::filesystem::path& file,
                                             const models::RobotArguments& robot) {
  models::SceneMeshes meshes(file.parent_path(), models::packages_of(robot).value_or_throw());
  std::map<std::string, Problem> problems;
  read_each_line(
      file, [](const std::string& text) { return json::problem_from_json(text); },
      [&](Problem problem) {
        if (const auto error = meshes.read(problem.scene, problem.attached))
          throw Failure(error->code, file.string() + ": " + error->message);
        problems.emplace(problem.name, std::move(problem));
      });
  if (problems.empty())
    throw Failure(ErrorCode::InvalidInput, "'" + file.string() + "' holds no problem");
  return problems;
}

std::vector<ProblemResult> read_results(const std::filesystem::path& file) {
  std::vector<ProblemResult> results;
  read_each_line(
      file, [](const std::string& text) { return json::problem_result_from_json(text); },
      [&](ProblemResult result) { results.push_back(std::move(result)); });
  return results;
}

Distribution read_distribution(const std::filesystem::path& file) {
  std::ifstream stream = files::open_input(file);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  Result<Distribution> distribution = json::distribution_from_json(text);
  if (!distribution)
    throw Failure(distribution.error().code, file.string() + ": " + distribution.error().message);
  if (!distribution->mixture)
    throw Failure(ErrorCode::InvalidInput, file.string() + ": the distribution has no mixture");
  return *std::move(distribution);
}

std::map<std::string, RecordedSearch> read_searches(const std::filesystem::path& file) {
  std::map<std::string, RecordedSearch> searches;
  if (!file.empty())
    read_each_line(
        file, [](const std::string& text) { return json::recorded_search_from_json(text); },
        [&](RecordedSearch search) {
          std::string name = search.name;
          searches.emplace(std::move(name), std::move(search));
        });
  return searches;
}

}  // namespace kinship::results
