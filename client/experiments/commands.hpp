#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <vector>

#include "client/experiments/page/run_files.hpp"
#include "client/experiments/station_problems.hpp"
#include "robots/models/robot_arguments.hpp"

/// The commands of kinship-experiments: options in, streams out. They throw Failure.
namespace kinship::experiments {

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

struct CompareOptions {
  std::filesystem::path uniform;
  std::filesystem::path guided;
  std::vector<AlsoFile> also;
  bool json = false;
};

/// Compares two result files of kinship-plan, and others beside them; in Python, in place of this
/// program.
[[noreturn]] void run_comparison(const CompareOptions& options);

/// Writes a page for people that tells what a run did, and shows it.
void write_page(const RunLocation& run, std::ostream& out);

}  // namespace kinship::experiments
