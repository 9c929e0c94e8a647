#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "robots/models/robot_arguments.hpp"

/// `problems from-moveit`, which needs no server.
namespace kinship::cli {

struct MoveItCommandOptions {
  models::RobotArguments robot;
  std::vector<std::filesystem::path> requests;  ///< one per problem
  std::vector<std::filesystem::path> scenes;    ///< none, one for all, or one per request
  std::filesystem::path folder;  ///< instead: requestNAME.yaml, each with its sceneNAME.yaml
  std::string placement;         ///< T_task_base; empty: the task frame is the planning frame
  std::filesystem::path output;  ///< empty: standard output, not for scenes with meshes
};

/// Writes one problem per line. Features that a problem cannot express are named on `err`, once
/// each; a request that cannot be converted ends the command, and the output keeps its old content.
int convert_moveit(const MoveItCommandOptions& options, std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
