#pragma once

#include <vector>

#include "proto/types/result.hpp"
#include "robots/kinematics/link_tree.hpp"
#include "robots/models/robot_arguments.hpp"

namespace kinship::models {

/// A robot's links before somebody says which of them are base and tip.
struct LinksOfFile {
  std::vector<kinematics::TreeLink> tree;
  std::vector<kinematics::ChainEnds> ends;  ///< that it could have, the likeliest first
  bool is_suggested = false;  ///< base or tip were not given, and are the likeliest now
};

/// Reads the links of a URDF file or model folder and completes the arguments of a bare URDF: base
/// and tip, as far as they are missing, and a label that is allowed.
/// \return what describe_robot() says of the files; InvalidInput if no joint moves, or none does
///         between a given end and the links that could be the other one.
Result<LinksOfFile> complete_ends(RobotArguments& arguments);

}  // namespace kinship::models
