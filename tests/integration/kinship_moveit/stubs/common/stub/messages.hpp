#pragma once

#include <cstdint>
#include <string>
#include <vector>

/// The members of ROS messages that client/ros2/kinship_moveit reads or writes.
namespace std_msgs::msg {
struct Header {
  std::string frame_id;
};
}  // namespace std_msgs::msg

namespace geometry_msgs::msg {
struct Point {
  double x = 0, y = 0, z = 0;
};
struct Vector3 {
  double x = 0, y = 0, z = 0;
};
struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
};
struct Pose {
  Point position;
  Quaternion orientation;
};
}  // namespace geometry_msgs::msg

namespace moveit_msgs::msg {
struct MoveItErrorCodes {
  enum {
    UNDEFINED = 0,
    SUCCESS = 1,
    FAILURE = 99999,
    PLANNING_FAILED = -1,
    INVALID_MOTION_PLAN = -2,
    PREEMPTED = -7,
    INVALID_GOAL_CONSTRAINTS = -16
  };
  std::int32_t val = UNDEFINED;
};
struct JointConstraint {
  std::string joint_name;
  double position = 0, tolerance_above = 0, tolerance_below = 0;
};
struct BoundingVolume {
  std::vector<geometry_msgs::msg::Pose> primitive_poses;
};
struct PositionConstraint {
  std_msgs::msg::Header header;
  std::string link_name;
  geometry_msgs::msg::Vector3 target_point_offset;
  BoundingVolume constraint_region;
};
struct OrientationConstraint {
  enum : std::uint8_t { XYZ_EULER_ANGLES = 0, ROTATION_VECTOR = 1 };
  std_msgs::msg::Header header;
  geometry_msgs::msg::Quaternion orientation;
  std::string link_name;
  double absolute_x_axis_tolerance = 0, absolute_y_axis_tolerance = 0,
         absolute_z_axis_tolerance = 0;
  std::uint8_t parameterization = XYZ_EULER_ANGLES;
};
struct VisibilityConstraint {};
struct Constraints {
  std::string name;
  std::vector<JointConstraint> joint_constraints;
  std::vector<PositionConstraint> position_constraints;
  std::vector<OrientationConstraint> orientation_constraints;
  std::vector<VisibilityConstraint> visibility_constraints;
};
struct TrajectoryConstraints {
  std::vector<Constraints> constraints;
};
struct RobotState {};
struct WorkspaceParameters {
  std_msgs::msg::Header header;
};
struct MotionPlanRequest {
  WorkspaceParameters workspace_parameters;
  RobotState start_state;
  std::vector<Constraints> goal_constraints;
  Constraints path_constraints;
  TrajectoryConstraints trajectory_constraints;
  std::string planner_id, group_name;
  double allowed_planning_time = 0;
};
}  // namespace moveit_msgs::msg
