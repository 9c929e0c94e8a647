#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

#include "client/experiments/studies/instance_draws.hpp"
#include "proto/types/problem.hpp"
#include "robots/models/loaded_robot.hpp"
#include "robots/models/robot_arguments.hpp"

namespace kinship::experiments {

/// The tasks of the quickstart.
enum class Station {
  Machine,  ///< a part goes from a pallet through the door of a machine
  Shelf     ///< a box goes from a table into a compartment of a shelf
};

/// "machine" or "shelf", which is what names of instances begin with.
std::string_view to_text(Station station);

/// Pose of a robot's base in the task frame from which the task is comfortable: known for
/// panda, iiwa14 and ur10e of robots/models, identity for others.
Eigen::Isometry3d placement_at(Station station, std::string_view label);

/// One planning problem: the robot holds something in a random free configuration over where it
/// took it, the goal is a pose of the transfer frame.
///
/// The scene, the pick and the goal pose depend on seed and index only, so that robots can be
/// compared; the start is the robot's own. Where the robot has no free start or no free goal, the
/// instance is drawn again with the next sub-seed, and its name ends in ".1", ".2" and so on:
/// equal names, equal scenes.
/// \param key  its draw is where to begin.
/// \throws Failure(NotFound) if no draw out of kMaxDraws can be done by the robot.
Problem draw_station_problem(Station station, const models::LoadedRobot& robot,
                             const Eigen::Isometry3d& T_task_base, const InstanceKey& key);

inline constexpr std::uint32_t kMaxDraws = 50;

/// The command line of `machine` and `shelf`.
struct StationOptions {
  Station station = Station::Machine;
  models::RobotArguments robot;
  std::uint32_t count = 40;
  std::uint64_t seed = 1;
  std::optional<Eigen::Isometry3d> T_task_base;  ///< empty: placement_at of the robot's label
};

/// Writes `count` problems of the task, one JSON document a line; progress on `messages`.
void write_station_problems(const StationOptions& options, std::ostream& out,
                            std::ostream& messages);

/// Writes "x y z qx qy qz qw" of the robot's placement in the task.
void write_placement(Station station, const models::RobotArguments& robot, std::ostream& out);

}  // namespace kinship::experiments
