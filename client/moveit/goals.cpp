#include "client/moveit/goals.hpp"

#include <limits>
#include <map>
#include <numbers>

#include "client/moveit/geometry_messages.hpp"

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

Eigen::VectorXd read_goal_joints(const YamlValue& list, const kinematics::Chain& chain) {
  JointValues values;
  for (const YamlValue& joint : list.items())
    values[joint["joint_name"].text()] = joint["position"].number();
  return in_order(values, chain, list);
}

void append_column(Eigen::MatrixXd& columns, const Eigen::VectorXd& column) {
  columns.conservativeResize(column.size(), columns.cols() + 1);
  columns.rightCols(1) = column;
}

/// An orientation to be kept: roll, pitch and yaw of the link in the frame wanted stay within the
/// tolerances; from half a turn on there is no bound. Source: moveit_msgs/OrientationConstraint,
/// parametrisation XYZ_EULER_ANGLES, whose order of turns is the other one; small ones agree.
TaskSpaceRegion read_kept_orientation(const YamlValue& constraint, const Frames& frames) {
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  TaskSpaceRegion region;
  region.T_task_region.linear() = frames.T_task_header(constraint).linear() *
                                  read_rotation(constraint["orientation"]).toRotationMatrix();
  region.T_region_end = frames.T_link_transfer(constraint["link_name"]);
  Eigen::Vector<double, 6> tolerance = Eigen::Vector<double, 6>::Constant(kUnbounded);
  constexpr const char* kTolerances[] = {"absolute_x_axis_tolerance", "absolute_y_axis_tolerance",
                                         "absolute_z_axis_tolerance"};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double value = constraint[kTolerances[axis]].number();
    if (value < std::numbers::pi)
      tolerance(3 + axis) = value;
  }
  region.bounds.row(0) = -tolerance;
  region.bounds.row(1) = tolerance;
  return region;
}

}  // namespace

Eigen::VectorXd read_start(const YamlValue& scene, const YamlValue& request,
                           const kinematics::Chain& chain) {
  JointValues values;
  read_joints(scene["robot_state"]["joint_state"], values);
  const YamlValue start = request["start_state"]["joint_state"];
  read_joints(start, values);
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
                    read_goal_joints(goal["joint_constraints"], chain));
      continue;
    }
    if (problem.T_task_goal)
      goal.refuse("a second goal pose; a problem has one, or several configurations");
    problem.T_task_goal = read_goal_pose(goal, frames);
  }
  if (problem.T_task_goal && problem.goal_configurations.cols() > 0)
    request["goal_constraints"].refuse("a pose and configurations; a problem has one or the other");
  conversion.left_out.push_back("tolerances of the goal: a problem's goal is exact");
  const YamlValue kept = request["path_constraints"];
  refuse_others(kept, {"joint_constraints", "position_constraints", "visibility_constraints"});
  if (!kept["orientation_constraints"].items().empty())
    problem.constraint = read_kept_orientation(only_one(kept["orientation_constraints"]), frames);
  if (!request["trajectory_constraints"]["constraints"].items().empty())
    request["trajectory_constraints"]["constraints"].refuse("a problem cannot say this");
}

}  // namespace kinship::moveit
