#include "settings.hpp"

#include <algorithm>
#include <stdexcept>

namespace kinship_moveit {
namespace {

template <typename Value>
Value read(rclcpp::Node& node, const std::string& name, const Value& otherwise) {
  if (!node.has_parameter(name))
    node.declare_parameter(name, otherwise);
  Value value = otherwise;
  node.get_parameter(name, value);
  return value;
}

/// \param otherwise  the default, which may lie below 0: not said.
template <typename Number>
Number read_up_to(rclcpp::Node& node, const std::string& name, Number otherwise, Number most) {
  const Number value = read(node, name, otherwise);
  if (!(value <= most) || (value < 0 && value != otherwise))
    throw std::invalid_argument(name + " is " + std::to_string(value) + ", must be 0 to " +
                                std::to_string(most));
  return value;
}

}  // namespace

Settings read_settings(rclcpp::Node& node) {
  using Texts = std::vector<std::string>;
  Settings settings;
  settings.task = read(node, "kinship.task", std::string());
  settings.tasks_ahead = read(node, "kinship.tasks_ahead", Texts());
  settings.groups = read(node, "kinship.groups", Texts());
  settings.task_from_workspace = read(node, "kinship.task_from_workspace", false);
  settings.task_frame = read(node, "kinship.task_frame", std::string());
  settings.server = read(node, "kinship.server", std::string());
  settings.security = read(node, "kinship.security", std::string());
  settings.outbox = read(node, "kinship.outbox", std::string());
  settings.profile = read(node, "kinship.profile", std::string());
  settings.machine = read(node, "kinship.machine", std::string());
  settings.label = read(node, "kinship.label", std::string());
  settings.axes = read(node, "kinship.axes", std::string());
  settings.robot = read(node, "kinship.robot", std::string());
  // Others declare these, and look whether somebody did.
  if (node.has_parameter("robot_description"))
    node.get_parameter("robot_description", settings.urdf);
  if (node.has_parameter("robot_description_semantic"))
    node.get_parameter("robot_description_semantic", settings.srdf);
  settings.domain = read_up_to(node, "kinship.domain", -1, 230);
  settings.timeout_ms = read_up_to(node, "kinship.timeout_ms", 2000, 60'000);
  settings.first_wait_ms = read_up_to(node, "kinship.first_wait_ms", 50, 1000);
  const auto transfer = read(node, "kinship.transfer", std::vector<double>{0, 0, 0, 0, 0, 0, 1});
  if (transfer.size() != settings.T_tip_transfer.size())
    throw std::invalid_argument("kinship.transfer has " + std::to_string(transfer.size()) +
                                " numbers, must have 7: x y z qx qy qz qw");
  std::copy(transfer.begin(), transfer.end(), settings.T_tip_transfer.begin());
  settings.share = read_up_to(node, "kinship.share", -1.0, 1.0);
  settings.control_fraction = read_up_to(node, "kinship.control_fraction", 0.1, 1.0);
  settings.offers_recall = read(node, "kinship.offer_recall", true);
  settings.reports = read(node, "kinship.report", true);
  settings.planner_plugin = read(node, "kinship.planner_plugin", std::string());
  return settings;
}

}  // namespace kinship_moveit
