#include "client/moveit/goals.hpp"

#include <algorithm>
#include <map>

#include "client/moveit/geometry_messages.hpp"
#include "client/moveit/kept_orientation.hpp"
#include "proto/types/number_text.hpp"

namespace kinship::moveit {
namespace {

using JointValues = std::map<std::string, double>;

/// sensor_msgs/JointState
void read_joints(const YamlValue& state, JointValues& values) {
  const std::vector<YamlValue> names = state["name"].items();
  const std::vector<YamlValue> positions = state["position"].items();
  if (names.size() != positions.size())
    state["position"].refuse(std::to_string(positions.size()) + " positions of " +
                             std::to_string(names.size()) + " joints");
  for (std::size_t index = 0; index < names.size(); ++index)
    values[names[index].text()] = positions[index].number();
}

/// \param place  is blamed for a joint of which nothing is said.
Eigen::VectorXd in_order(const JointValues& values, const kinematics::Chain& chain,
                         const YamlValue& place) {
  Eigen::VectorXd q(chain.dof());
  for (Eigen::Index joint = 0; joint < chain.dof(); ++joint) {
    const std::string& name = chain.joints()[static_cast<std::size_t>(joint)].name;
    const auto value = values.find(name);
    if (value == values.end())
      place.refuse("nothing is said of joint '" + name + "'");
    q(joint) = value->second;
  }
  return q;
}

/// Tells of joints that a state names and the chain does not have.
void note_others(const JointValues& values, const kinematics::Chain& chain, const std::string& of,
                 const std::string& advice, std::vector<std::string>& left_out) {
  for (const auto& [name, value] : values)
    if (std::ranges::find(chain.joints(), name, &kinematics::Joint::name) == chain.joints().end())
      left_out.push_back(of + " of joint '" + name + "', " + number_text(value) +
                         ": not of the chain" + advice);
}

/// A list with exactly one element.
YamlValue only_one(const YamlValue& list) {
  const std::vector<YamlValue> items = list.items();
  if (items.size() != 1)
    list.refuse(std::to_string(items.size()) + " of them instead of one");
  return items.front();
}

void refuse_others(const YamlValue& constraints, std::initializer_list<const char*> kinds) {
  for (const char* kind : kinds)
    if (!constraints[kind].items().empty())
      constraints[kind].refuse("a problem cannot say this");
}

/// Where a link's frame has to be, from moveit_msgs/PositionConstraint and OrientationConstraint:
/// the middle of the region, and the orientation wanted.
Eigen::Isometry3d read_goal_pose(const YamlValue& constraints, const Frames& frames) {
  const YamlValue position = only_one(constraints["position_constraints"]);
  const YamlValue orientation = only_one(constraints["orientation_constraints"]);
  if (position["link_name"].text() != orientation["link_name"].text())
    orientation["link_name"].refuse("another link than that of the position, '" +
                                    position["link_name"].text() + "'");
  const YamlValue region = position["constraint_region"];
  refuse_others(region, {"meshes"});
  const Eigen::Vector3d middle =
      frames.T_task_header(position) * read_pose(only_one(region["primitive_poses"])).translation();
  Eigen::Isometry3d T_task_link(frames.T_task_header(orientation).linear() *
                                read_rotation(orientation["orientation"]).toRotationMatrix());
  T_task_link.translation() =
      middle - T_task_link.linear() * read_vector(position["target_point_offset"]);
  return T_task_link * frames.T_link_transfer(position["link_name"]);
}

Eigen::VectorXd read_goal_joints(const YamlValue& list, const kinematics::Chain& chain,
                                 std::vector<std::string>& left_out) {
  JointValues values;
  for (const YamlValue& joint : list.items())
    values[joint["joint_name"].text()] = joint["position"].number();
  note_others(values, chain, "goal", "", left_out);
  return in_order(values, chain, list);
}

void append_column(Eigen::MatrixXd& columns, const Eigen::VectorXd& column) {
  columns.conservativeResize(column.size(), columns.cols() + 1);
  columns.rightCols(1) = column;
}

}  // namespace

Eigen::VectorXd read_start(const YamlValue& scene, const YamlValue& request,
                           const kinematics::Chain& chain, std::vector<std::string>& left_out) {
  JointValues values;
  read_joints(scene["robot_state"]["joint_state"], values);
  const YamlValue start = request["start_state"]["joint_state"];
  read_joints(start, values);
  note_others(values, chain, "start", "; --hold says where it stands", left_out);
  return in_order(values, chain, start);
}

void read_goals(const YamlValue& request, const kinematics::Chain& chain, const Frames& frames,
                Conversion& conversion) {
  Problem& problem = conversion.problem;
  const std::vector<YamlValue> goals = request["goal_constraints"].items();
  if (goals.empty())
    request["goal_constraints"].refuse("there is no goal");
  for (const YamlValue& goal : goals) {
    refuse_others(goal, {"visibility_constraints"});
    if (!goal["joint_constraints"].items().empty()) {
      refuse_others(goal, {"position_constraints", "orientation_constraints"});
      append_column(problem.goal_configurations,
                    read_goal_joints(goal["joint_constraints"], chain, conversion.left_out));
      continue;
    }
    if (problem.T_task_goal)
      goal.refuse("a second goal pose; a problem has one, or several configurations");
    problem.T_task_goal = read_goal_pose(goal, frames);
  }
  if (problem.T_task_goal && problem.goal_configurations.cols() > 0)
    request["goal_constraints"].refuse("a pose and configurations; a problem has one or the other");
  conversion.left_out.push_back("tolerances of the goal: a problem's goal is exact");
  problem.constraint = read_constraint(request, frames, conversion.left_out);
}

std::optional<TaskSpaceRegion> read_constraint(const YamlValue& request, const Frames& frames,
                                               std::vector<std::string>& left_out) {
  const YamlValue kept = request["path_constraints"];
  refuse_others(kept, {"joint_constraints", "position_constraints", "visibility_constraints"});
  if (!request["trajectory_constraints"]["constraints"].items().empty())
    request["trajectory_constraints"]["constraints"].refuse("a problem cannot say this");
  if (kept["orientation_constraints"].items().empty())
    return std::nullopt;
  return read_kept_orientation(only_one(kept["orientation_constraints"]), frames, left_out);
}

}  // namespace kinship::moveit
