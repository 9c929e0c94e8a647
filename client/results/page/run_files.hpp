#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "proto/types/distribution.hpp"
#include "proto/types/problem.hpp"
#include "proto/types/recorded_search.hpp"
#include "robots/models/loaded_robot.hpp"

/// The files of a run as values. All throw Failure(NotFound) that names a file that is missing, or
/// Failure(InvalidInput) that names the file, and the line, that is broken.
namespace kinship::results {

/// By name, with their meshes read. \param robot  for packages.
std::map<std::string, Problem> read_problems(const std::filesystem::path& file,
                                             const models::RobotArguments& robot);

/// The lines of a result file of kinship-plan.
std::vector<ProblemResult> read_results(const std::filesystem::path& file);

/// Refuses one without a mixture.
Distribution read_distribution(const std::filesystem::path& file);

/// By the name of the problem. \param file  empty: none.
std::map<std::string, RecordedSearch> read_searches(const std::filesystem::path& file);

}  // namespace kinship::results
