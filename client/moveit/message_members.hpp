#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "client/moveit/yaml_value.hpp"

namespace kinship::moveit {

/// How a member of a message is treated.
enum class MemberUse {
  Read,      ///< by Kinship, or it has members that are
  Anything,  ///< not used: may hold anything in YAML
  NotInRos2  ///< of ROS 1, Humble or benchmark sets: in YAML, and not in messages as ROS 2 has them
};

/// A member of a message.
struct Member {
  std::string name;
  std::string type;  ///< a message or a primitive; with [] a list of it, with [N] of N
  MemberUse use = MemberUse::Read;
};

/// The members of a message in the order of ROS 2; none: `message` is a primitive type.
/// Source: moveit_msgs, shape_msgs, geometry_msgs, sensor_msgs, trajectory_msgs, std_msgs,
/// octomap_msgs, object_recognition_msgs, builtin_interfaces; benchmark sets.
const std::vector<Member>& members_of(std::string_view message);

/// The parts of a Member's type.
struct MessageType {
  std::string_view name;  ///< of a message or primitive
  bool is_list = false;
  std::size_t fixed_count = 0;  ///< of a list; 0: any
};

MessageType message_type(std::string_view type);

/// Checks that a document has the structure of one of MoveIt's messages: maps and lists in the same
/// places, and no other members, so that a misspelt one is reported. Unused members may hold
/// anything, and each may be missing.
/// \param message  e.g. PlanningScene or MotionPlanRequest.
/// \throws Failure(InvalidInput) that names the place, and the likely member.
void check_members(const YamlValue& document, const char* message);

}  // namespace kinship::moveit
