"""Messages of ROS 2 as a middleware writes them: CDR of DDS, packed by the .msg files' text. Shares nothing with the reader in C++."""
import re
import struct

# moveit_msgs and what its messages are made of, as the releases from Humble on have them: the members in order.
MESSAGES = {
    "Time": "int32 sec, uint32 nanosec",
    "Header": "Time stamp, string frame_id",
    "Vector3": "float64 x, float64 y, float64 z",
    "Quaternion": "float64 x, float64 y, float64 z, float64 w",
    "Pose": "Vector3 position, Quaternion orientation",
    "Transform": "Vector3 translation, Quaternion rotation",
    "TransformStamped": "Header header, string child_frame_id, Transform transform",
    "Twist": "Vector3 linear, Vector3 angular",
    "Wrench": "Vector3 force, Vector3 torque",
    "PoseStamped": "Header header, Pose pose",
    "Point32": "float32 x, float32 y, float32 z",
    "Polygon": "Point32[] points",
    "ColorRGBA": "float32 r, float32 g, float32 b, float32 a",
    "SolidPrimitive": "uint8 type, float64[] dimensions, Polygon polygon",
    "MeshTriangle": "uint32[3] vertex_indices",
    "Mesh": "MeshTriangle[] triangles, Vector3[] vertices",
    "Plane": "float64[4] coef",
    "ObjectType": "string key, string db",
    "CollisionObject": "Header header, Pose pose, string id, ObjectType type, SolidPrimitive[] primitives, Pose[] primitive_poses, "
                       "Mesh[] meshes, Pose[] mesh_poses, Plane[] planes, Pose[] plane_poses, string[] subframe_names, "
                       "Pose[] subframe_poses, uint8 operation",
    "JointTrajectoryPoint": "float64[] positions, float64[] velocities, float64[] accelerations, float64[] effort, Time time_from_start",
    "JointTrajectory": "Header header, string[] joint_names, JointTrajectoryPoint[] points",
    "MultiDOFJointTrajectoryPoint": "Transform[] transforms, Twist[] velocities, Twist[] accelerations, Time time_from_start",
    "MultiDOFJointTrajectory": "Header header, string[] joint_names, MultiDOFJointTrajectoryPoint[] points",
    "RobotTrajectory": "JointTrajectory joint_trajectory, MultiDOFJointTrajectory multi_dof_joint_trajectory",
    "AttachedCollisionObject": "string link_name, CollisionObject object, string[] touch_links, JointTrajectory detach_posture, "
                               "float64 weight",
    "JointState": "Header header, string[] name, float64[] position, float64[] velocity, float64[] effort",
    "MultiDOFJointState": "Header header, string[] joint_names, Transform[] transforms, Twist[] twist, Wrench[] wrench",
    "RobotState": "JointState joint_state, MultiDOFJointState multi_dof_joint_state, "
                  "AttachedCollisionObject[] attached_collision_objects, bool is_diff",
    "AllowedCollisionEntry": "bool[] enabled",
    "AllowedCollisionMatrix": "string[] entry_names, AllowedCollisionEntry[] entry_values, string[] default_entry_names, "
                              "bool[] default_entry_values",
    "LinkPadding": "string link_name, float64 padding",
    "LinkScale": "string link_name, float64 scale",
    "ObjectColor": "string id, ColorRGBA color",
    "Octomap": "Header header, bool binary, string id, float64 resolution, int8[] data",
    "OctomapWithPose": "Header header, Pose origin, Octomap octomap",
    "PlanningSceneWorld": "CollisionObject[] collision_objects, OctomapWithPose octomap",
    "PlanningScene": "string name, RobotState robot_state, string robot_model_name, TransformStamped[] fixed_frame_transforms, "
                     "AllowedCollisionMatrix allowed_collision_matrix, LinkPadding[] link_padding, LinkScale[] link_scale, "
                     "ObjectColor[] object_colors, PlanningSceneWorld world, bool is_diff",
    "WorkspaceParameters": "Header header, Vector3 min_corner, Vector3 max_corner",
    "JointConstraint": "string joint_name, float64 position, float64 tolerance_above, float64 tolerance_below, float64 weight",
    "BoundingVolume": "SolidPrimitive[] primitives, Pose[] primitive_poses, Mesh[] meshes, Pose[] mesh_poses",
    "PositionConstraint": "Header header, string link_name, Vector3 target_point_offset, BoundingVolume constraint_region, float64 weight",
    "OrientationConstraint": "Header header, Quaternion orientation, string link_name, float64 absolute_x_axis_tolerance, "
                             "float64 absolute_y_axis_tolerance, float64 absolute_z_axis_tolerance, uint8 parameterization, float64 weight",
    "VisibilityConstraint": "float64 target_radius, PoseStamped target_pose, int32 cone_sides, PoseStamped sensor_pose, "
                            "float64 max_view_angle, float64 max_range_angle, uint8 sensor_view_direction, float64 weight",
    "Constraints": "string name, JointConstraint[] joint_constraints, PositionConstraint[] position_constraints, "
                   "OrientationConstraint[] orientation_constraints, VisibilityConstraint[] visibility_constraints",
    "TrajectoryConstraints": "Constraints[] constraints",
    "CartesianPoint": "Pose pose, Twist velocity, Twist acceleration",
    "CartesianTrajectoryPoint": "CartesianPoint point, Time time_from_start",
    "CartesianTrajectory": "Header header, string tracked_frame, CartesianTrajectoryPoint[] points",
    "GenericTrajectory": "Header header, JointTrajectory[] joint_trajectory, CartesianTrajectory[] cartesian_trajectory",
    "MotionPlanRequest": "WorkspaceParameters workspace_parameters, RobotState start_state, Constraints[] goal_constraints, "
                         "Constraints path_constraints, TrajectoryConstraints trajectory_constraints, "
                         "GenericTrajectory[] reference_trajectories, string pipeline_id, string planner_id, string group_name, "
                         "int32 num_planning_attempts, float64 allowed_planning_time, float64 max_velocity_scaling_factor, "
                         "float64 max_acceleration_scaling_factor, string cartesian_speed_limited_link, float64 max_cartesian_speed",
}
FORMATS = {"bool": "?", "uint8": "B", "int8": "b", "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}


class _Writer:
    def __init__(self, order: str):
        self.order, self.bytes = order, b""

    def number(self, kind: str, value) -> None:
        size = struct.calcsize(FORMATS[kind])
        self.bytes += bytes(-len(self.bytes) % size) + struct.pack(self.order + FORMATS[kind], value)

    def value(self, kind: str, value) -> None:
        sequence = re.fullmatch(r"(\w+)\[(\d*)\]", kind)
        if sequence:
            value = value if value is not None else [None] * int(sequence[2] or 0)
            if sequence[2]:
                assert len(value) == int(sequence[2]), (kind, value)
            else:
                self.number("uint32", len(value))
            for each in value:
                self.value(sequence[1], each)
        elif kind == "string":
            text = (value or "").encode() + b"\0"
            self.number("uint32", len(text))
            self.bytes += text
        elif kind in FORMATS:
            self.number(kind, value or 0)
        else:
            value = dict(value or {})
            for member in MESSAGES[kind].split(", "):
                member_kind, name = member.split()
                self.value(member_kind, value.pop(name, None))
            assert not value, f"{kind} has no {list(value)}"


def cdr(message: str, value: dict, little_endian: bool = True) -> bytes:
    """A message; what `value` lacks is zero or empty."""
    writer = _Writer("<" if little_endian else ">")
    writer.value(message, value)
    return bytes([0, 1 if little_endian else 0, 0, 0]) + writer.bytes
