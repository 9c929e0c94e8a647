#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>

#include "client/experiments/page/run_files.hpp"
#include "robots/models/robot_arguments.hpp"

/// The commands of kinship-experiments: options in, streams out. They throw Failure.
namespace kinship::experiments {

struct ShelfOptions {
  models::RobotArguments robot;
  std::uint32_t count = 40;
  std::uint64_t seed = 1;
  std::optional<Eigen::Isometry3d> T_task_base;  ///< empty: shelf_placement of the robot's label
};

/// Writes `count` problems of the shelf task, one JSON document a line; progress on `messages`.
void write_shelf_problems(const ShelfOptions& options, std::ostream& out, std::ostream& messages);

/// Writes "x y z qx qy qz qw" of the robot's placement in the shelf task.
void write_placement(const models::RobotArguments& robot, std::ostream& out);

struct CompareOptions {
  std::filesystem::path uniform;
  std::filesystem::path guided;
  bool json = false;
};

/// Compares two result files of kinship-plan.
void write_comparison(const CompareOptions& options, std::ostream& out);

/// Writes a page for people that tells what a run did, and shows it.
void write_page(const RunLocation& run, std::ostream& out);

}  // namespace kinship::experiments
