#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>

#include "robots/models/robot_arguments.hpp"

/// `robots fk` and `robots ik`, which need no server.
namespace kinship::cli {

struct ForwardCommandOptions {
  models::RobotArguments robot;
  std::string configuration;             ///< joint units, separated by spaces
  std::filesystem::path configurations;  ///< JSON Lines of them; empty: `configuration` counts
  std::string placement;                 ///< T_task_base; empty: poses are in the base link
  bool json = false;
};

/// Poses of tip link and transfer frame, for one configuration or for each line of a file.
int place_configurations(const ForwardCommandOptions& options, std::ostream& out,
                         std::ostream& err);

struct InverseCommandOptions {
  models::RobotArguments robot;
  std::string pose;             ///< of the frame in the base link, "x y z qx qy qz qw"
  std::filesystem::path poses;  ///< JSON Lines of [x, y, z, qx, qy, qz, qw]; empty: `pose` counts
  std::string frame = "tip";    ///< the frame of the pose: "tip" or "transfer"
  std::string placement;        ///< T_task_base; with it poses are in the task frame
  bool collision_free = false;  ///< colliding solutions are left out and counted
  double clearance_m = 1e-3;    ///< nearer bodies touch; see collision::EdgeProofOptions
  std::filesystem::path scene;  ///< a problem file; its first problem gives the surroundings
  int max_solutions = 8;        ///< 0: all
  double min_distance = 0.2;
  std::uint64_t seed = 0;
  bool json = false;
};

/// Configurations for one pose, or for each line of a file in its order. No solution is an
/// answer, with its reason.
int solve_poses(const InverseCommandOptions& options, std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
