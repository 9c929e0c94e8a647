#pragma once

#include <string>

#include "robots/kinematics/timed_path.hpp"
#include "robots/kinematics/urdf.hpp"

/// Stored paths as MoveIt's messages in YAML, as `ros2 topic echo` writes and `ros2 topic pub`
/// reads them.
namespace kinship::moveit {

/// moveit_msgs/RobotTrajectory of the joints of the chain: positions and times, without velocities.
/// The frame is the URDF's root link.
/// \param note  on the first line, as a comment.
/// \throws std::invalid_argument if the path has another number of joints.
std::string robot_trajectory_text(const kinematics::RobotModel& robot,
                                  const kinematics::TimedPath& path, const std::string& note);

/// moveit_msgs/DisplayTrajectory, as RViz shows it: the same with the URDF's name and the start,
/// in which the held joints are, too.
std::string display_trajectory_text(const kinematics::RobotModel& robot,
                                    const kinematics::TimedPath& path, const std::string& note);

}  // namespace kinship::moveit
