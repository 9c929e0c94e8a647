#pragma once

#include <Eigen/Geometry>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/recorded_scene.hpp"
#include "robots/collision/robot_solids.hpp"
#include "server/transfer/filters.hpp"

namespace kinship::transfer {

/// What surrounds a robot that stands among recorded objects and holds in its transfer frame what
/// was held. Pairs that touch in at least 38 of 40 random configurations within the limits may
/// touch, as a base and the table below it (seeded: equal input, equal answers); of two links that
/// is not asked. \param scene keeps the rules of check_scene().
collision::Surroundings recorded_surroundings(const collision::RobotSolids& robot,
                                              const RecordedScene& scene,
                                              const Eigen::Isometry3d& T_task_base);

/// A filter made of a recorded scene for one robot.
struct SceneFilter {
  /// Empty if there is nothing to touch: no shapes of the robot, or no object.
  ConfigurationFilter keep;
  /// Names of two things that touch wherever the robot goes, as a base and the table below it, or
  /// a wrist and what is held: they say nothing about a configuration and are not looked at.
  std::vector<std::pair<std::string, std::string>> always_touching;
};

/// Keeps the configurations in which the robot, standing among the recorded objects and holding in
/// its transfer frame what was held, touches no object, and what it holds touches neither an object
/// nor the robot. Whether the robot touches itself is another filter's question. The scene's
/// constraint is ignored.
///
/// Pairs that touch in at least 38 of 40 random configurations within the limits are left out
/// (seeded: equal input, equal answers). Not shared between threads.
/// \param scene        keeps the rules of check_scene().
/// \param T_task_base  placement of the robot; identity if it is missing.
SceneFilter scene_filter(const collision::RobotSolids& robot, const RecordedScene& scene,
                         const Eigen::Isometry3d& T_task_base);

}  // namespace kinship::transfer
