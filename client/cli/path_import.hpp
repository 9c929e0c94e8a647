#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

namespace kinship::cli {

struct ImportOptions {
  std::filesystem::path file;  ///< JSON Lines; "-": `standard_input`; empty: one of the next
  std::filesystem::path moveit_warehouse;   ///< a database of warehouse_ros_sqlite
  std::filesystem::path ompl_planner_data;  ///< a file of ompl::base::PlannerDataStorage
  std::string robot;      ///< of these two: a label at the server, or the beginning of a digest
  std::string task;       ///< of these two; empty: the name of the planning scene or cache
  std::string placement;  ///< T_task_base, "x y z qx qy qz qw"; empty: MoveIt's planning frame
  bool json = false;      ///< the counts as one document
  bool progress = false;  ///< names what was delivered last on `err`
};

/// `paths import`: sends the lines of an experience file to the server and registers the robots
/// that it describes, or sends what another program has kept. May be repeated: the server
/// recognizes stored reports by their UUID. \return kFailed if something was refused (each is named
/// on `err`); kNoServer if no server
///         answered.
/// \throws Failure if the file cannot be read.
int import_paths(link::Client& server, const ImportOptions& options, std::istream& standard_input,
                 std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
