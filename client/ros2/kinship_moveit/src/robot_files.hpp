#pragma once

#include <filesystem>
#include <string>

#include "handles.hpp"
#include "settings.hpp"

namespace kinship_moveit {

/// The robot as libkinship reads it: `kinship.robot`, or files with the texts of robot_description
/// and robot_description_semantic, which are removed with this object.
class RobotFiles {
 public:
  /// \throws std::invalid_argument if there is no description; std::filesystem::filesystem_error.
  explicit RobotFiles(const Settings& settings);
  ~RobotFiles();
  RobotFiles(const RobotFiles&) = delete;
  RobotFiles& operator=(const RobotFiles&) = delete;

  /// Valid as long as this object and the settings.
  kinship_robot_file describe() const;

 private:
  std::filesystem::path folder_;  // empty: none was made
  std::string source_, srdf_, axes_;
};

}  // namespace kinship_moveit
