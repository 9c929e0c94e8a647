#pragma once

#include <vector>

#include "proto/types/result.hpp"
#include "robots/kinematics/link_tree.hpp"
#include "robots/models/robot_arguments.hpp"

namespace kinship::models {

/// A robot's links before base and tip are given.
struct LinksOfFile {
  std::vector<kinematics::TreeLink> tree;
  std::vector<kinematics::ChainEnds> ends;  ///< the possible ones, the likeliest first
  bool is_suggested = false;  ///< base or tip were not given, and are now the likeliest ones
};

/// Reads the links of a URDF file or model folder and completes the arguments of a bare URDF: base
/// and tip, as far as they are missing, and an allowed label.
/// \return also the errors of describe_robot() on the files; InvalidInput if no joint moves, or
///         none between a given end and the possible other ends.
Result<LinksOfFile> complete_ends(RobotArguments& arguments);

}  // namespace kinship::models
