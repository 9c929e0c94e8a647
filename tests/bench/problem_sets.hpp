#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/experiments/studies/study.hpp"
#include "client/planner/problem_lines.hpp"
#include "tests/bench/problem_files.hpp"

namespace kinship::bench {

/// Studies out of problem files (problem_files.hpp): one a kind, of the robots that have it. The
/// first half of a file is for learning, the other one is every other set.
/// \throws std::runtime_error if a file cannot be read.
inline std::vector<experiments::Study> studies_of(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::map<std::string, experiments::Study> studies;
  for (const fs::path& file : files_below(folder, kProblemsEnding)) {
    const std::string kind = kind_of(file);
    experiments::Study& study = studies[kind];
    study.name = kind;
    study.settings.overshoot = 1;
    study.settings.max_checks = 1'000'000;
    study.robots.push_back({.model = fs::absolute(file.parent_path())});
    study.make_instances = [kind](const models::LoadedRobot&,
                                  const experiments::StudyRobot& robot) {
      std::ifstream stream(fs::path(robot.model) / (kind + kProblemsEnding));
      std::vector<Problem> problems;
      for (planner::ProblemLine& line : planner::read_problem_lines(stream))
        problems.push_back(std::move(line.problem).value_or_throw());
      return [problems](std::uint64_t seed, std::uint32_t index) {
        const std::size_t half = problems.size() / 2;
        bool is_learning = false;
        for (std::size_t other = 0; other < 8; ++other)
          is_learning |= seed == experiments::seed_of(experiments::InstanceSet::Learning, other);
        Problem problem = problems.at((index % half) + (is_learning ? 0 : half));
        problem.seed = index;
        return problem;
      };
    };
  }
  std::vector<experiments::Study> found;
  for (auto& [kind, study] : studies)
    found.push_back(std::move(study));
  return found;
}

}  // namespace kinship::bench
