#pragma once

#include <iosfwd>
#include <set>
#include <string>
#include <vector>

#include "proto/types/problem.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::planner {

/// Says of each scene what cannot be meant; the same of many problems once.
class GeometryWarnings {
 public:
  /// References; they outlive the object.
  GeometryWarnings(const models::LoadedRobot& robot, std::ostream& messages)
      : robot_(robot), messages_(messages) {}

  /// Obstacles that the robot cannot touch wherever it goes. \param problem  with its meshes read.
  void tell_of(const Problem& problem);

  /// What lies wholly within a closed mesh.
  void tell_of(const Problem& problem,
               const std::vector<collision::CollisionWorld::Enclosed>& enclosed);

 private:
  void tell(const Problem& problem, const std::string& sentence);

  const models::LoadedRobot& robot_;
  std::ostream& messages_;
  std::set<std::string> told_;
};

}  // namespace kinship::planner
