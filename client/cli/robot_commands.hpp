#pragma once

#include <cstdint>
#include <iosfwd>

#include "client/link/client.hpp"
#include "robots/models/robot_arguments.hpp"

/// `robots check`, which needs no server, and `robots register`.
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

/// `robots register`: sends a robot's description to the server.
int register_robot(link::Client& server, const models::RobotArguments& arguments, bool json,
                   std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
