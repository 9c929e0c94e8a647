#pragma once

#include <filesystem>
#include <iosfwd>

#include "robots/models/robot_arguments.hpp"

namespace kinship::cli {

struct InitOptions {
  models::RobotArguments robot;       ///< of a URDF file; base and tip may be missing
  std::filesystem::path folder = {};  ///< of the chain.toml; empty: the URDF's
  bool force = false;                 ///< replaces a chain.toml
};

/// `robots init`: writes the chain.toml of a URDF file, and says what it has and why: what was
/// given, else what is likeliest, or what the answers say.
/// \param answers  of the person who is asked on `err`, a line each, empty for what is proposed;
///                 null: nothing is asked.
/// \return wrong usage if there is a chain.toml already, or the robot is none.
int init_robot(const InitOptions& options, std::istream* answers, std::ostream& out,
               std::ostream& err);

}  // namespace kinship::cli
