#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "robots/models/loaded_robot.hpp"

/// Problem files of one's own: DIR/ROBOT/KIND.problems.jsonl, beside robot.urdf, chain.toml and, if
/// there is one, robot.srdf.
namespace kinship::bench {

inline const std::string kProblemsEnding = ".problems.jsonl";

/// Files in a folder and in those below it, by the ending of their names; in order.
/// \throws std::filesystem::filesystem_error if it is no folder.
inline std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder,
                                                      const std::string& ending) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().filename().string().ends_with(ending))
      files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

/// Of a file of problems.
inline std::string kind_of(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return name.substr(0, name.size() - kProblemsEnding.size());
}

/// The robot of a folder.
/// \throws Failure if it cannot be read.
inline models::LoadedRobot load_robot_of(const std::filesystem::path& folder) {
  models::RobotArguments arguments;
  arguments.source = folder;
  if (std::filesystem::exists(folder / "robot.srdf"))
    arguments.srdf = folder / "robot.srdf";
  return models::load_robot(arguments).value_or_throw();
}

}  // namespace kinship::bench
