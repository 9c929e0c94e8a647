#include "client/moveit/message_members.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/nearest_name.hpp"

namespace kinship::moveit {
namespace {

struct Member {
  std::string name;
  std::string type = {};  ///< a message, with [] a list of it; empty: not looked at here
};

/// The messages by name, with their members in ROS 1 and 2, and messages of benchmark sets.
/// Source: moveit_msgs, shape_msgs, geometry_msgs, sensor_msgs, std_msgs, octomap_msgs.
// NOLINTNEXTLINE(readability-function-size): a table
const std::map<std::string, std::vector<Member>, std::less<>>& messages() {
  static const std::map<std::string, std::vector<Member>, std::less<>> kMessages = {
      {"PlanningScene",
       {{"name"},
        {"robot_state", "RobotState"},
        {"robot_model_name"},
        {"fixed_frame_transforms", "TransformStamped[]"},
        {"allowed_collision_matrix", "AllowedCollisionMatrix"},
        {"link_padding", "LinkPadding[]"},
        {"link_scale", "LinkScale[]"},
        {"object_colors"},
        {"world", "PlanningSceneWorld"},
        {"is_diff"}}},
      {"PlanningSceneWorld",
       {{"collision_objects", "CollisionObject[]"}, {"octomap", "OctomapWithPose"}}},
      {"OctomapWithPose", {{"header", "Header"}, {"origin", "Pose"}, {"octomap", "Octomap"}}},
      {"Octomap", {{"header", "Header"}, {"binary"}, {"id"}, {"resolution"}, {"data"}}},
      {"CollisionObject",
       {{"header", "Header"},
        {"pose", "Pose"},
        {"id"},
        {"type"},
        {"primitives", "SolidPrimitive[]"},
        {"primitive_poses", "Pose[]"},
        {"meshes", "Mesh[]"},
        {"mesh_poses", "Pose[]"},
        {"planes", "Plane[]"},
        {"plane_poses", "Pose[]"},
        {"subframe_names"},
        {"subframe_poses", "Pose[]"},
        {"operation"}}},
      {"SolidPrimitive", {{"type"}, {"dimensions"}, {"polygon"}}},
      // A file's name and its scale, of benchmark sets.
      {"Mesh",
       {{"triangles", "MeshTriangle[]"},
        {"vertices", "Point[]"},
        {"resource"},
        {"scale", "Vector3"},
        {"dimensions", "Vector3"}}},
      {"MeshTriangle", {{"vertex_indices"}}},
      {"Plane", {{"coef"}}},
      {"AttachedCollisionObject",
       {{"link_name"},
        {"object", "CollisionObject"},
        {"touch_links"},
        {"detach_posture"},
        {"weight"}}},
      {"RobotState",
       {{"joint_state", "JointState"},
        {"multi_dof_joint_state", "MultiDOFJointState"},
        {"attached_collision_objects", "AttachedCollisionObject[]"},
        {"is_diff"}}},
      {"JointState", {{"header", "Header"}, {"name"}, {"position"}, {"velocity"}, {"effort"}}},
      {"MultiDOFJointState",
       {{"header", "Header"},
        {"joint_names"},
        {"transforms", "Transform[]"},
        {"twist"},
        {"wrench"}}},
      {"TransformStamped", {{"header", "Header"}, {"child_frame_id"}, {"transform", "Transform"}}},
      {"AllowedCollisionMatrix",
       {{"entry_names"},
        {"entry_values", "AllowedCollisionEntry[]"},
        {"default_entry_names"},
        {"default_entry_values"}}},
      {"AllowedCollisionEntry", {{"enabled"}}},
      {"LinkPadding", {{"link_name"}, {"padding"}}},
      {"LinkScale", {{"link_name"}, {"scale"}}},
      {"MotionPlanRequest",
       {{"workspace_parameters", "WorkspaceParameters"},
        {"start_state", "RobotState"},
        {"goal_constraints", "Constraints[]"},
        {"path_constraints", "Constraints"},
        {"trajectory_constraints", "TrajectoryConstraints"},
        {"reference_trajectories"},
        {"pipeline_id"},
        {"planner_id"},
        {"group_name"},
        {"num_planning_attempts"},
        {"allowed_planning_time"},
        {"max_velocity_scaling_factor"},
        {"max_acceleration_scaling_factor"},
        {"cartesian_speed_end_effector_link"},
        {"cartesian_speed_limited_link"},
        {"max_cartesian_speed"}}},
      {"WorkspaceParameters",
       {{"header", "Header"}, {"min_corner", "Vector3"}, {"max_corner", "Vector3"}}},
      {"Constraints",
       {{"name"},
        {"joint_constraints", "JointConstraint[]"},
        {"position_constraints", "PositionConstraint[]"},
        {"orientation_constraints", "OrientationConstraint[]"},
        {"visibility_constraints", "VisibilityConstraint[]"}}},
      {"TrajectoryConstraints", {{"constraints", "Constraints[]"}}},
      {"JointConstraint",
       {{"joint_name"}, {"position"}, {"tolerance_above"}, {"tolerance_below"}, {"weight"}}},
      {"PositionConstraint",
       {{"header", "Header"},
        {"link_name"},
        {"target_point_offset", "Vector3"},
        {"constraint_region", "BoundingVolume"},
        {"weight"}}},
      {"BoundingVolume",
       {{"primitives", "SolidPrimitive[]"},
        {"primitive_poses", "Pose[]"},
        {"meshes", "Mesh[]"},
        {"mesh_poses", "Pose[]"}}},
      {"OrientationConstraint",
       {{"header", "Header"},
        {"orientation", "Quaternion"},
        {"link_name"},
        {"absolute_x_axis_tolerance"},
        {"absolute_y_axis_tolerance"},
        {"absolute_z_axis_tolerance"},
        {"parameterization"},
        {"weight"}}},
      {"VisibilityConstraint",
       {{"target_radius"},
        {"target_pose"},
        {"cone_sides"},
        {"sensor_pose"},
        {"max_view_angle"},
        {"max_range_angle"},
        {"sensor_view_direction"},
        {"weight"}}},
      {"Header", {{"seq"}, {"stamp"}, {"frame_id"}}},
      {"Pose", {{"position", "Point"}, {"orientation", "Quaternion"}}},
      {"Transform", {{"translation", "Vector3"}, {"rotation", "Quaternion"}}},
      {"Point", {{"x"}, {"y"}, {"z"}}},
      {"Vector3", {{"x"}, {"y"}, {"z"}}},
      {"Quaternion", {{"x"}, {"y"}, {"z"}, {"w"}}}};
  return kMessages;
}

/// Messages that benchmark sets write as lists of their values.
constexpr std::array<std::string_view, 5> kAlsoLists = {"Point", "Vector3", "Quaternion",
                                                        "MeshTriangle", "AllowedCollisionEntry"};

void check(const YamlValue& value, std::string_view type) {
  if (value.is_missing() || type.empty())
    return;
  if (type.ends_with("[]")) {
    for (const YamlValue& item : value.items())
      check(item, type.substr(0, type.size() - 2));
    return;
  }
  if (std::ranges::count(kAlsoLists, type) > 0 && value.is_list())
    return;
  const std::vector<Member>& members = messages().find(type)->second;
  std::vector<std::string> names;
  for (const Member& member : members)
    names.push_back(member.name);
  std::set<std::string> seen;
  if (!value.is_map())
    value.refuse("is no " + std::string(type) + ": a map of its members is expected");
  for (const auto& [name, member] : value.members()) {
    if (std::ranges::count(names, name) == 0)
      member.refuse("'" + name + "' is no member of " + std::string(type) +
                    suggestion(name, names));
    if (!seen.insert(name).second)
      member.refuse("'" + name + "' is there twice");
  }
  for (const Member& member : members)
    check(value[member.name], member.type);
}

}  // namespace

void check_members(const YamlValue& document, const char* message) { check(document, message); }

}  // namespace kinship::moveit
