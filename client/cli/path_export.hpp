#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "client/link/client.hpp"

namespace kinship::cli {

struct ExportOptions {
  std::string robot, task;       ///< filters; empty: all
  std::vector<std::string> ids;  ///< of paths: only these, without filters and limit
  std::size_t limit = 0;         ///< the newest paths in use; 0: all attempts
  std::filesystem::path output;  ///< JSON Lines; empty: standard output
  std::filesystem::path mcap;    ///< instead: a recording; "-": standard output
  /// Instead: DisplayTrajectory documents in a file, "-": standard output; in a folder (that
  /// exists, or ends with '/') a DisplayTrajectory and a RobotTrajectory for each path.
  std::filesystem::path moveit;
  bool progress = false;  ///< on `err`, unless the rows go to a terminal themselves
};

/// `paths export`: attempts as JSON Lines, each after its robot, or their paths as a recording for
/// viewers or as trajectories of MoveIt. A file has its name only if all came.
/// \return kNotFound, without a file, if there is no path to write.
int export_paths(link::Client& server, const ExportOptions& options, std::ostream& out,
                 std::ostream& err);

}  // namespace kinship::cli
