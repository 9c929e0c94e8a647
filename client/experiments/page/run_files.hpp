#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robots/models/robot_arguments.hpp"

namespace kinship::experiments {

/// What an experienced robot did: its problems and what kinship-plan answered.
struct TeacherFiles {
  models::RobotArguments robot;
  std::filesystem::path problems, results;
};

/// Results of kinship-plan over the same problems that are shown beside those of guided sampling,
/// e.g. of one guide alone.
struct AlsoFile {
  std::string name;  ///< for people, e.g. "mixture alone"
  std::filesystem::path results;
};

/// The files of a run that a page tells of: a robot that planned the same problems with uniform and
/// with guided sampling.
struct RunFiles {
  models::RobotArguments robot;
  std::filesystem::path problems;
  std::filesystem::path uniform, guided;  ///< results of kinship-plan
  std::filesystem::path distribution;     ///< kinship distributions fetch --json, of before
  std::filesystem::path advice;           ///< the same of after; empty: the page has no advice
  /// kinship-plan --searches; empty: the page does not show how searches grew.
  std::filesystem::path uniform_searches, guided_searches;
  std::vector<AlsoFile> also;  ///< may be empty
  std::vector<TeacherFiles> teachers;
};

/// What a command line says of a run.
struct RunLocation {
  RunFiles files;                     ///< those that are named; the others are looked for
  std::filesystem::path folder;       ///< where, by the names of deploy/quickstart; may be empty
  std::filesystem::path models;       ///< folder of model folders; may be empty
  std::string robot;                  ///< beginning of its files' names; empty: the only one
  std::vector<std::string> teachers;  ///< likewise; empty: all there are
};

/// Looks in the folder for what is not named: ROBOT.problems.jsonl, ROBOT-uniform.results.jsonl,
/// ROBOT-guided.results.jsonl, distribution.json, and if they are there advice.json,
/// ROBOT-uniform.searches.jsonl, ROBOT-guided.searches.jsonl, of a guide alone
/// ROBOT-GUIDE.results.jsonl (mixture, ways, retreat) and, of every teacher,
/// TEACHER.problems.jsonl and TEACHER.results.jsonl. Models are MODELS/ROBOT.
/// \throws Failure(NotFound) that says all that is missing, and how it is named.
RunFiles find_run(const RunLocation& options);

/// "MODEL,PROBLEMS,RESULTS". \throws Failure(InvalidInput) if it is not.
TeacherFiles parse_teacher(const std::string& text);

/// "NAME=FILE". \throws Failure(InvalidInput) if it is not.
AlsoFile parse_also(const std::string& text);

}  // namespace kinship::experiments
