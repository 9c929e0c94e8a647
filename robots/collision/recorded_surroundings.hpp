#pragma once

#include <Eigen/Geometry>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/recorded_scene.hpp"
#include "robots/collision/robot_solids.hpp"

namespace kinship::collision {

struct RecordedSurroundings {
  Surroundings surroundings;  ///< its allowed pairs include the next ones
  /// Names of pairs that touch in almost every configuration, such as a base and the table below
  /// it, or a wrist and a held object.
  std::vector<std::pair<std::string, std::string>> always_touching;
};

/// Surroundings of a robot among the recorded objects, with the held objects in its transfer frame.
/// Pairs that touch in at least 38 of 40 random configurations within the limits may touch (seeded:
/// equal input, equal answers); pairs of links are not tested for that.
/// \param scene  keeps the rules of check_scene().
RecordedSurroundings recorded_surroundings(const RobotSolids& robot, const RecordedScene& scene,
                                           const Eigen::Isometry3d& T_task_base);

}  // namespace kinship::collision
