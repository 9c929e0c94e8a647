#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "client/experiments/page/run_files.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/problem.hpp"
#include "proto/types/recorded_search.hpp"
#include "robots/models/loaded_robot.hpp"

/// The files of a run as values. All throw Failure that names the file, and the line, that is
/// missing or broken.
namespace kinship::experiments {

/// By name, with their meshes read. \param robot  for packages.
std::map<std::string, Problem> read_problems(const std::filesystem::path& file,
                                             const models::RobotArguments& robot);

/// Refuses one without a mixture.
Distribution read_distribution(const std::filesystem::path& file);

/// By the name of the problem. \param file  empty: none.
std::map<std::string, RecordedSearch> read_searches(const std::filesystem::path& file);

/// The problem of an attempt, if it is one of this robot.
/// \param what  names the file in messages.
const Problem& problem_of(const std::map<std::string, Problem>& problems, const std::string& name,
                          const std::filesystem::path& what);

/// Refuses a path that is not of this robot.
const Eigen::MatrixXd& checked_path(const models::LoadedRobot& robot, const ProblemResult& result,
                                    const std::filesystem::path& what);

}  // namespace kinship::experiments
