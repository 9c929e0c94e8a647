#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>

#include "client/link/client.hpp"
#include "robots/models/robot_arguments.hpp"

/// `robots check` and `robots ik`, which need no server, and `robots register`.
namespace kinship::cli {

struct CheckOptions {
  models::RobotArguments robot;
  int poses = 200;  ///< reachable poses to solve
  int max_solutions = 8;
  double min_distance = 0.2;
  std::uint64_t seed = 0;
  bool json = false;
};

/// The chain, its limits, transfer frame, task axes and collision shapes, the solver chosen, and
/// solutions and CPU time per reachable pose.
int check_robot(const CheckOptions& options, std::ostream& out, std::ostream& err);

struct InverseCommandOptions {
  models::RobotArguments robot;
  std::string pose;             ///< of the tip link in the base link, "x y z qx qy qz qw"
  std::filesystem::path poses;  ///< JSON Lines of [x, y, z, qx, qy, qz, qw]; empty: `pose` counts
  int max_solutions = 8;        ///< 0: all
  double min_distance = 0.2;
  std::uint64_t seed = 0;
  bool json = false;
};

/// Configurations for one pose, or for each line of a file in its order. No solution is an
/// answer, with its reason.
int solve_poses(const InverseCommandOptions& options, std::ostream& out, std::ostream& err);

/// `robots register`: hands a robot's description to the server.
int register_robot(link::Client& server, const models::RobotArguments& arguments, bool json,
                   std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
