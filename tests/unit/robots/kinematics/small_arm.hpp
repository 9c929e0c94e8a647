#pragma once

#include <string>

#include "proto/types/robot_description.hpp"

namespace kinship::kinematics {

inline std::string joint_text(const std::string& name, const std::string& type,
                              const std::string& parent, const std::string& child,
                              const std::string& inside = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent +
         "'/><child link='" + child + "'/>" + inside + "</joint>";
}

inline const std::string kLimit = "<limit lower='-1' upper='2' effort='1' velocity='1'/>";
inline const std::string kAlongZ = "<axis xyz='0 0 1'/>";

/// A URDF with these links, separated by blanks, and the text of its joints.
inline std::string robot_text(const std::string& links, const std::string& joints) {
  std::string text = "<?xml version='1.0'?><robot name='small'>";
  std::size_t start = 0;
  while (start < links.size()) {
    const std::size_t end = std::min(links.find(' ', start), links.size());
    text += "<link name='" + links.substr(start, end - start) + "'/>";
    start = end + 1;
  }
  return text + joints + "</robot>";
}

/// A description of the chain from 'base' to 'tip'.
inline RobotDescription described(const std::string& urdf) {
  RobotDescription description;
  description.label = "small";
  description.urdf = urdf;
  description.base_link = "base";
  description.tip_link = "tip";
  return description;
}

/// base -j1- mid -j2- tip, with `inside` as the content of j2, of type `type`.
inline RobotDescription two_joints(const std::string& type, const std::string& inside) {
  return described(
      robot_text("base mid tip", joint_text("j1", "revolute", "base", "mid", kLimit + kAlongZ) +
                                     joint_text("j2", type, "mid", "tip", inside)));
}

}  // namespace kinship::kinematics
