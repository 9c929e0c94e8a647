#include "client/moveit/trajectory_text.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>

#include "proto/types/names.hpp"
#include "proto/types/number_text.hpp"

namespace kinship::moveit {
namespace {

constexpr const char* kQuoted = "!";  // the tag of a text that is no number

/// A float as YAML 1.1 knows it: "1.0", "1.0e-07".
std::string float_text(double value) {
  std::string text = number_text(value);
  if (text.find('.') == std::string::npos)
    text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

/// On one line.
YAML::Node empty_list() {
  YAML::Node list(YAML::NodeType::Sequence);
  list.SetStyle(YAML::EmitterStyle::Flow);
  return list;
}

/// In quotes: a joint may be called `on`, or `1`.
YAML::Node name_node(const std::string& name) {
  YAML::Node node(name);
  node.SetTag(kQuoted);
  return node;
}

YAML::Node float_list(const Eigen::Ref<const Eigen::VectorXd>& values) {
  YAML::Node list = empty_list();
  for (const double value : values)
    list.push_back(float_text(value));
  return list;
}

YAML::Node time_node(std::chrono::nanoseconds time) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
  YAML::Node node;
  node["sec"] = seconds.count();
  node["nanosec"] = (time - seconds).count();
  return node;
}

YAML::Node header(const kinematics::RobotModel& robot) {
  YAML::Node node;
  node["stamp"] = time_node({});
  node["frame_id"] = name_node(robot.chain.links().front().name);
  return node;
}

YAML::Node joint_names(const kinematics::RobotModel& robot) {
  YAML::Node names = empty_list();
  for (const kinematics::Joint& joint : robot.chain.joints())
    names.push_back(name_node(joint.name));
  return names;
}

YAML::Node joint_trajectory(const kinematics::RobotModel& robot,
                            const kinematics::TimedPath& path) {
  if (path.configurations.rows() != robot.chain.dof())
    throw std::invalid_argument("a path of " + std::to_string(path.configurations.rows()) +
                                " joints, the robot has " + std::to_string(robot.chain.dof()));
  YAML::Node points(YAML::NodeType::Sequence);
  for (std::size_t i = 0; i < path.times.size(); ++i) {
    YAML::Node point;
    point["positions"] = float_list(path.configurations.col(static_cast<Eigen::Index>(i)));
    for (const char* member : {"velocities", "accelerations", "effort"})
      point[member] = empty_list();
    point["time_from_start"] = time_node(path.times[i]);
    points.push_back(point);
  }
  YAML::Node node;
  node["header"] = header(robot);
  node["joint_names"] = joint_names(robot);
  node["points"] = points;
  return node;
}

YAML::Node robot_trajectory(const kinematics::RobotModel& robot,
                            const kinematics::TimedPath& path) {
  YAML::Node without_motion;
  without_motion["header"] = header(robot);
  without_motion["joint_names"] = empty_list();
  without_motion["points"] = empty_list();
  YAML::Node node;
  node["joint_trajectory"] = joint_trajectory(robot, path);
  node["multi_dof_joint_trajectory"] = without_motion;
  return node;
}

/// moveit_msgs/RobotState: joints that it does not name stay where they are.
YAML::Node robot_state(const kinematics::RobotModel& robot,
                       const Eigen::Ref<const Eigen::VectorXd>& q) {
  YAML::Node names = joint_names(robot), positions = float_list(q);
  for (const auto& [name, value] : kinematics::held_values(robot)) {
    names.push_back(name_node(name));
    positions.push_back(float_text(value));
  }
  YAML::Node joints;
  joints["header"] = header(robot);
  joints["name"] = names;
  joints["position"] = positions;
  joints["velocity"] = empty_list();
  joints["effort"] = empty_list();
  YAML::Node node;
  node["joint_state"] = joints;
  node["attached_collision_objects"] = empty_list();
  node["is_diff"] = true;
  return node;
}

/// yaml-cpp's own way forgets the quotes.
void emit(const YAML::Node& node, YAML::Emitter& emitter) {
  if (node.IsMap()) {
    emitter << YAML::BeginMap;
    for (const auto& member : node) {
      emitter << YAML::Key << member.first.Scalar() << YAML::Value;
      emit(member.second, emitter);
    }
    emitter << YAML::EndMap;
  } else if (node.IsSequence()) {
    if (node.Style() == YAML::EmitterStyle::Flow)
      emitter << YAML::Flow;
    emitter << YAML::BeginSeq;
    for (const YAML::Node& value : node)
      emit(value, emitter);
    emitter << YAML::EndSeq;
  } else {
    if (node.Tag() == kQuoted)
      emitter << YAML::DoubleQuoted;
    emitter << node.Scalar();
  }
}

std::string text_of(const YAML::Node& document, const std::string& note) {
  YAML::Emitter emitter;
  emit(document, emitter);
  return "# " + on_one_line(note) + "\n" + emitter.c_str() + "\n";
}

}  // namespace

std::string robot_trajectory_text(const kinematics::RobotModel& robot,
                                  const kinematics::TimedPath& path, const std::string& note) {
  return text_of(robot_trajectory(robot, path), note);
}

std::string display_trajectory_text(const kinematics::RobotModel& robot,
                                    const kinematics::TimedPath& path, const std::string& note) {
  YAML::Node trajectories(YAML::NodeType::Sequence);
  trajectories.push_back(robot_trajectory(robot, path));
  YAML::Node node;
  node["model_id"] = name_node(kinematics::name_in_urdf(robot));
  node["trajectory"] = trajectories;
  node["trajectory_start"] = robot_state(robot, path.configurations.col(0));
  return text_of(node, note);
}

}  // namespace kinship::moveit
