#pragma once

#include <iosfwd>
#include <string>

#include "robots/models/robot_arguments.hpp"

/// Commands that help to choose base, tip and transfer frame of a URDF; they need no server.
namespace kinship::cli {

struct LinksOptions {
  models::RobotArguments robot;  ///< without base and tip the likeliest ones are taken
  bool json = false;
};

/// `robots links`: every link with its joint, solids and the links that it is never checked
/// against.
int list_links(const LinksOptions& options, std::ostream& out, std::ostream& err);

struct FramesOptions {
  models::RobotArguments robot;  ///< the same
  std::string configuration =
      {};                      ///< joint values, separated by spaces; empty: 0, within the limits
  std::string placement = {};  ///< T_task_base; empty: poses in the base link
  bool json = false;
};

/// `robots frames`: the poses of every link and the transfer frame at a configuration.
int list_frames(const FramesOptions& options, std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
