#pragma once

#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>

#include "handles.hpp"

namespace kinship_moveit {

/// The parameters `kinship.*` of a node, documented in config/panda_kinship.yaml.
struct Settings {
  std::string task;
  std::vector<std::string> tasks_ahead;
  std::vector<std::string> groups;
  bool task_from_workspace = false;
  std::string task_frame;
  std::string server, security, outbox, profile, machine, label, axes, robot;
  std::string urdf, srdf;  ///< texts of robot_description and robot_description_semantic
  int domain = -1;
  int timeout_ms = 2000, first_wait_ms = 50;
  PoseNumbers T_tip_transfer{0, 0, 0, 0, 0, 0, 1};
  double share = -1, control_fraction = 0.1;
  bool offers_recall = true, reports = true;
  std::string planner_plugin;
};

/// Declares those that are not, and reads all.
/// \throws std::invalid_argument that names a parameter with a value out of its range.
Settings read_settings(rclcpp::Node& node);

}  // namespace kinship_moveit
