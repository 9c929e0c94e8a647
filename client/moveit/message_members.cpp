#include "client/moveit/message_members.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/nearest_name.hpp"

namespace kinship::moveit {
namespace {

constexpr MemberUse kAnything = MemberUse::Anything, kOther = MemberUse::NotInRos2;

}  // namespace

// NOLINTNEXTLINE(readability-function-size): a table
const std::vector<Member>& members_of(std::string_view message) {
  static const std::map<std::string, std::vector<Member>, std::less<>> kMessages = {
      {"PlanningScene",
       {{"name", "string"},
        {"robot_state", "RobotState"},
        {"robot_model_name", "string"},
        {"fixed_frame_transforms", "TransformStamped[]"},
        {"allowed_collision_matrix", "AllowedCollisionMatrix"},
        {"link_padding", "LinkPadding[]"},
        {"link_scale", "LinkScale[]"},
        {"object_colors", "ObjectColor[]", kAnything},
        {"world", "PlanningSceneWorld"},
        {"is_diff", "bool"}}},
      {"PlanningSceneWorld",
       {{"collision_objects", "CollisionObject[]"}, {"octomap", "OctomapWithPose"}}},
      {"OctomapWithPose", {{"header", "Header"}, {"origin", "Pose"}, {"octomap", "Octomap"}}},
      {"Octomap",
       {{"header", "Header"},
        {"binary", "bool"},
        {"id", "string"},
        {"resolution", "float64"},
        {"data", "int8[]"}}},
      {"CollisionObject",
       {{"header", "Header"},
        {"pose", "Pose"},
        {"id", "string"},
        {"type", "ObjectType", kAnything},
        {"primitives", "SolidPrimitive[]"},
        {"primitive_poses", "Pose[]"},
        {"meshes", "Mesh[]"},
        {"mesh_poses", "Pose[]"},
        {"planes", "Plane[]"},
        {"plane_poses", "Pose[]"},
        {"subframe_names", "string[]"},
        {"subframe_poses", "Pose[]"},
        {"operation", "uint8"}}},
      {"ObjectType", {{"key", "string"}, {"db", "string"}}},
      {"ObjectColor", {{"id", "string"}, {"color", "ColorRGBA"}}},
      {"ColorRGBA", {{"r", "float32"}, {"g", "float32"}, {"b", "float32"}, {"a", "float32"}}},
      {"SolidPrimitive",
       {{"type", "uint8"}, {"dimensions", "float64[]"}, {"polygon", "Polygon", kAnything}}},
      {"Polygon", {{"points", "Point32[]"}}},
      {"Point32", {{"x", "float32"}, {"y", "float32"}, {"z", "float32"}}},
      // A file's name and its scale, of benchmark sets.
      {"Mesh",
       {{"triangles", "MeshTriangle[]"},
        {"vertices", "Point[]"},
        {"resource", "string", kOther},
        {"scale", "Vector3", kOther},
        {"dimensions", "Vector3", kOther}}},
      {"MeshTriangle", {{"vertex_indices", "uint32[3]"}}},
      {"Plane", {{"coef", "float64[4]"}}},
      {"AttachedCollisionObject",
       {{"link_name", "string"},
        {"object", "CollisionObject"},
        {"touch_links", "string[]"},
        {"detach_posture", "JointTrajectory", kAnything},
        {"weight", "float64"}}},
      {"RobotState",
       {{"joint_state", "JointState"},
        {"multi_dof_joint_state", "MultiDOFJointState"},
        {"attached_collision_objects", "AttachedCollisionObject[]"},
        {"is_diff", "bool"}}},
      {"JointState",
       {{"header", "Header"},
        {"name", "string[]"},
        {"position", "float64[]"},
        {"velocity", "float64[]"},
        {"effort", "float64[]"}}},
      {"MultiDOFJointState",
       {{"header", "Header"},
        {"joint_names", "string[]"},
        {"transforms", "Transform[]"},
        {"twist", "Twist[]", kAnything},
        {"wrench", "Wrench[]", kAnything}}},
      {"TransformStamped",
       {{"header", "Header"}, {"child_frame_id", "string"}, {"transform", "Transform"}}},
      {"AllowedCollisionMatrix",
       {{"entry_names", "string[]"},
        {"entry_values", "AllowedCollisionEntry[]"},
        {"default_entry_names", "string[]"},
        {"default_entry_values", "bool[]"}}},
      {"AllowedCollisionEntry", {{"enabled", "bool[]"}}},
      {"LinkPadding", {{"link_name", "string"}, {"padding", "float64"}}},
      {"LinkScale", {{"link_name", "string"}, {"scale", "float64"}}},
      {"MotionPlanRequest",
       {{"workspace_parameters", "WorkspaceParameters"},
        {"start_state", "RobotState"},
        {"goal_constraints", "Constraints[]"},
        {"path_constraints", "Constraints"},
        {"trajectory_constraints", "TrajectoryConstraints"},
        {"reference_trajectories", "GenericTrajectory[]", kAnything},
        {"pipeline_id", "string"},
        {"planner_id", "string"},
        {"group_name", "string"},
        {"num_planning_attempts", "int32"},
        {"allowed_planning_time", "float64"},
        {"max_velocity_scaling_factor", "float64"},
        {"max_acceleration_scaling_factor", "float64"},
        // Humble's name of the next one, which is where that is.
        {"cartesian_speed_end_effector_link", "string", kOther},
        {"cartesian_speed_limited_link", "string"},
        {"max_cartesian_speed", "float64"}}},
      {"WorkspaceParameters",
       {{"header", "Header"}, {"min_corner", "Vector3"}, {"max_corner", "Vector3"}}},
      {"Constraints",
       {{"name", "string"},
        {"joint_constraints", "JointConstraint[]"},
        {"position_constraints", "PositionConstraint[]"},
        {"orientation_constraints", "OrientationConstraint[]"},
        {"visibility_constraints", "VisibilityConstraint[]"}}},
      {"TrajectoryConstraints", {{"constraints", "Constraints[]"}}},
      {"JointConstraint",
       {{"joint_name", "string"},
        {"position", "float64"},
        {"tolerance_above", "float64"},
        {"tolerance_below", "float64"},
        {"weight", "float64"}}},
      {"PositionConstraint",
       {{"header", "Header"},
        {"link_name", "string"},
        {"target_point_offset", "Vector3"},
        {"constraint_region", "BoundingVolume"},
        {"weight", "float64"}}},
      {"BoundingVolume",
       {{"primitives", "SolidPrimitive[]"},
        {"primitive_poses", "Pose[]"},
        {"meshes", "Mesh[]"},
        {"mesh_poses", "Pose[]"}}},
      {"OrientationConstraint",
       {{"header", "Header"},
        {"orientation", "Quaternion"},
        {"link_name", "string"},
        {"absolute_x_axis_tolerance", "float64"},
        {"absolute_y_axis_tolerance", "float64"},
        {"absolute_z_axis_tolerance", "float64"},
        {"parameterization", "uint8"},
        {"weight", "float64"}}},
      {"VisibilityConstraint",
       {{"target_radius", "float64"},
        {"target_pose", "PoseStamped", kAnything},
        {"cone_sides", "int32"},
        {"sensor_pose", "PoseStamped", kAnything},
        {"max_view_angle", "float64"},
        {"max_range_angle", "float64"},
        {"sensor_view_direction", "uint8"},
        {"weight", "float64"}}},
      {"RobotTrajectory",
       {{"joint_trajectory", "JointTrajectory"},
        {"multi_dof_joint_trajectory", "MultiDOFJointTrajectory"}}},
      {"DisplayTrajectory",
       {{"model_id", "string"},
        {"trajectory", "RobotTrajectory[]"},
        {"trajectory_start", "RobotState"}}},
      {"JointTrajectory",
       {{"header", "Header"}, {"joint_names", "string[]"}, {"points", "JointTrajectoryPoint[]"}}},
      {"JointTrajectoryPoint",
       {{"positions", "float64[]"},
        {"velocities", "float64[]"},
        {"accelerations", "float64[]"},
        {"effort", "float64[]"},
        {"time_from_start", "Duration"}}},
      {"MultiDOFJointTrajectory",
       {{"header", "Header"},
        {"joint_names", "string[]"},
        {"points", "MultiDOFJointTrajectoryPoint[]"}}},
      {"MultiDOFJointTrajectoryPoint",
       {{"transforms", "Transform[]"},
        {"velocities", "Twist[]"},
        {"accelerations", "Twist[]"},
        {"time_from_start", "Duration"}}},
      {"GenericTrajectory",
       {{"header", "Header"},
        {"joint_trajectory", "JointTrajectory[]"},
        {"cartesian_trajectory", "CartesianTrajectory[]"}}},
      {"CartesianTrajectory",
       {{"header", "Header"},
        {"tracked_frame", "string"},
        {"points", "CartesianTrajectoryPoint[]"}}},
      {"CartesianTrajectoryPoint", {{"point", "CartesianPoint"}, {"time_from_start", "Duration"}}},
      {"CartesianPoint", {{"pose", "Pose"}, {"velocity", "Twist"}, {"acceleration", "Twist"}}},
      {"Duration", {{"sec", "int32"}, {"nanosec", "uint32"}}},
      {"Twist", {{"linear", "Vector3"}, {"angular", "Vector3"}}},
      {"Wrench", {{"force", "Vector3"}, {"torque", "Vector3"}}},
      {"PoseStamped", {{"header", "Header"}, {"pose", "Pose"}}},
      // ROS 1 counts headers; its times have other names.
      {"Header",
       {{"seq", "uint32", kOther}, {"stamp", "Duration", kAnything}, {"frame_id", "string"}}},
      {"Pose", {{"position", "Point"}, {"orientation", "Quaternion"}}},
      {"Transform", {{"translation", "Vector3"}, {"rotation", "Quaternion"}}},
      {"Point", {{"x", "float64"}, {"y", "float64"}, {"z", "float64"}}},
      {"Vector3", {{"x", "float64"}, {"y", "float64"}, {"z", "float64"}}},
      {"Quaternion", {{"x", "float64"}, {"y", "float64"}, {"z", "float64"}, {"w", "float64"}}}};
  static const std::vector<Member> kNone;
  const auto found = kMessages.find(message);
  return found == kMessages.end() ? kNone : found->second;
}

namespace {

/// Messages that benchmark sets write as lists of their values.
constexpr std::array<std::string_view, 5> kAlsoLists = {"Point", "Vector3", "Quaternion",
                                                        "MeshTriangle", "AllowedCollisionEntry"};

void check(const YamlValue& value, std::string_view type) {
  const MessageType kind = message_type(type);
  if (value.is_missing() || members_of(kind.name).empty())
    return;
  if (kind.is_list) {
    for (const YamlValue& item : value.items())
      check(item, kind.name);
    return;
  }
  if (std::ranges::count(kAlsoLists, type) > 0 && value.is_list())
    return;
  const std::vector<Member>& members = members_of(type);
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
    if (member.use != MemberUse::Anything)
      check(value[member.name], member.type);
}

}  // namespace

MessageType message_type(std::string_view type) {
  const std::size_t bracket = type.find('[');
  if (bracket == std::string_view::npos)
    return {type, false, 0};
  const std::string_view count = type.substr(bracket + 1, type.size() - bracket - 2);
  std::size_t fixed = 0;
  std::from_chars(count.data(), count.data() + count.size(), fixed);
  return {type.substr(0, bracket), true, fixed};
}

void check_members(const YamlValue& document, const char* message) { check(document, message); }

}  // namespace kinship::moveit
