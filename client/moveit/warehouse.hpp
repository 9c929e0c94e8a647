#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/moveit/conversion.hpp"
#include "proto/types/path.hpp"

/// Trajectories that MoveIt keeps in SQLite databases.
namespace kinship::moveit {

/// A trajectory of a warehouse: of a planning scene and its request, or of a cache.
struct StoredTrajectory {
  std::string name;            ///< e.g. "moveit_planning_scenes/robot_trajectory 3"
  std::string group;           ///< name of the planning scene, or of the cache's namespace
  std::string planner;         ///< of the request; empty: unknown
  double planning_time_s = 0;  ///< 0: unknown
  std::string bytes;           ///< the stored message: equal ones are one trajectory
  Path path;                   ///< joints in the order of the chain
  Eigen::Isometry3d T_task_base = Eigen::Isometry3d::Identity();
  /// The problem's objects, attached objects, allowed collisions and constraint, if the planning
  /// scene is there and can be expressed.
  std::optional<Conversion> scene = {};
  std::vector<std::string> left_out = {};  ///< why something is not in `path` or `scene`
};

/// Takes a trajectory, or the reason why a message is none for this robot. \return false: no more.
using UseTrajectory =
    std::function<bool(const std::string& name, Result<StoredTrajectory> trajectory)>;

/// Reads the trajectories of a database of warehouse_ros_sqlite (schema 10, ROS 2): those of
/// MoveIt's planning scene storage and of its trajectory caches. The file is not changed.
/// \param T_task_base  empty: the task frame is MoveIt's planning frame.
/// \return the messages of other kinds by collection, e.g. {"moveit_robot_states/robot_states of
///         moveit_msgs::msg::RobotState", 4}.
/// \throws Failure(NotFound or InvalidInput) that names the file if it is no such database.
/// Source: warehouse_ros_sqlite, SCHEMA.md.
std::map<std::string, std::size_t> read_warehouse(
    const std::filesystem::path& file, const kinematics::Chain& chain,
    const std::optional<Eigen::Isometry3d>& T_task_base, const UseTrajectory& use);

}  // namespace kinship::moveit
