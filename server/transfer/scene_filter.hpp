#pragma once

#include <Eigen/Geometry>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/recorded_scene.hpp"
#include "robots/collision/robot_solids.hpp"
#include "server/transfer/filters.hpp"

namespace kinship::transfer {

/// A filter made of a recorded scene for one robot.
struct SceneFilter {
  /// Empty if no contact is possible: no shapes of the robot, or no object.
  ConfigurationFilter keep;
  /// Names of pairs that touch in almost every configuration, such as a base and the table below
  /// it, or a wrist and a held object: they are ignored.
  std::vector<std::pair<std::string, std::string>> always_touching;
};

/// Keeps the configurations in which the robot, among the recorded objects and with the held
/// objects in its transfer frame, touches no object, and the held objects touch neither an object
/// nor the robot. Self-collision is left to another filter. The scene's constraint is ignored.
///
/// Pairs that touch in almost every configuration are left out (collision::recorded_surroundings).
/// Not shared between threads.
/// \param scene        keeps the rules of check_scene().
/// \param T_task_base  placement of the robot; identity if it is missing.
/// \param covers       null, or the robot with solids around its meshes, which are asked first.
SceneFilter scene_filter(const collision::RobotSolids& robot, const RecordedScene& scene,
                         const Eigen::Isometry3d& T_task_base,
                         const collision::RobotSolids* covers = nullptr);

}  // namespace kinship::transfer
