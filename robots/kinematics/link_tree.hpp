#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/result.hpp"

/// The links of a URDF before base and tip link are known.
namespace kinship::kinematics {

/// The joint from a link to its parent, as in the URDF.
struct TreeJoint {
  std::string name;
  std::string type;                    ///< revolute, continuous, prismatic, fixed, floating, planar
  std::optional<double> lower, upper;  ///< joint units; hard limits, if any
  std::string mimics = {};             ///< the joint that it follows; empty: none
  std::string fault = {};              ///< why it can be no joint of a robot; empty: it can

  /// Whether it can be a joint of a chain: it has one value of its own.
  bool moves() const {
    return mimics.empty() && (type == "revolute" || type == "continuous" || type == "prismatic");
  }
};

struct TreeLink {
  std::string name;
  int parent = -1;                          ///< index, below this link's own; -1: the root link
  TreeJoint joint;                          ///< to the parent; of the root link empty
  std::vector<std::string> collision = {};  ///< "box", "cylinder", "sphere" or "mesh" each
};

/// Every link of a URDF, in the order of Chain::links(): parents before their children.
/// \return the error of parse_urdf() for any other text.
Result<std::vector<TreeLink>> read_link_tree(const std::string& urdf);

/// Base and tip links that make an arm of a tree.
struct ChainEnds {
  std::vector<std::string> bases;  ///< no joint of its own between them; the likeliest first
  std::vector<std::string> tips;   ///< the same
  std::size_t joints = 0;          ///< moving ones between them
};

/// The arms of a tree, those with most joints first. An arm ends where no joint moves beyond, or
/// where several do (the fingers of a gripper) and none of these branches has three joints; a
/// branch with three joints begins an arm of its own from the same base, unless the joints before
/// it are a whole arm (the fingers of a hand). The joints of a gripper at an arm's end
/// (is_gripping_joint) are no part of it; the ends with these joints come after all others. The
/// likeliest base is the root link, or the first link below it if the root is a mere place
/// (`world`, `map`, `odom`, `base_footprint`); the likeliest tip the last link that is fixed to the
/// last joint, with `tool0`, `tcp` and the like before others.
std::vector<ChainEnds> suggest_ends(const std::vector<TreeLink>& tree);

/// Whether the joint above a link moves a finger or jaw rather than an arm: another joint follows
/// it, it slides less than an arm's axis does, a joint of the same kind hangs beside it, or it
/// turns to one side from closed and is named as a jaw or ends an arm of six joints.
/// \param link    index of the moving link
/// \param before  moving joints between the base and it
bool is_gripping_joint(const std::vector<TreeLink>& tree, std::size_t link, std::size_t before);

/// A sentence on each joint of a mobile base; empty for a robot that stands still.
std::vector<std::string> describe_mobile_base(const std::vector<TreeLink>& tree);

}  // namespace kinship::kinematics
