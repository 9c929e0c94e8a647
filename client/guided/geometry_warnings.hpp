#pragma once

#include <set>
#include <string>
#include <vector>

#include "client/guided/plan_problem.hpp"
#include "proto/types/problem.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::guided {

/// Says of each planned scene what cannot be meant; the same of many problems once.
class GeometryWarnings {
 public:
  /// References; they outlive the object.
  GeometryWarnings(const kinematics::Chain& chain, const geometry::RobotShapes& shapes)
      : chain_(chain), shapes_(shapes) {}

  /// Obstacles that the robot cannot touch wherever it goes, and what lies wholly within a closed
  /// mesh at the start: a sentence each that names the problem, but none that was given before.
  /// \param problem  with its meshes read.
  /// \param planned  what came of it.
  std::vector<std::string> find(const Problem& problem, const PlannedProblem& planned);

 private:
  const kinematics::Chain& chain_;
  const geometry::RobotShapes& shapes_;
  std::set<std::string> told_;
};

}  // namespace kinship::guided
