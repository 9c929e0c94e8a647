#pragma once

#include <set>
#include <string>
#include <vector>

#include "client/guided/plan_problem.hpp"
#include "proto/types/problem.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::guided {

/// Warns of implausible geometry in planned scenes; once per warning, however many problems share
/// it.
class GeometryWarnings {
 public:
  /// References; they outlive the object.
  GeometryWarnings(const kinematics::Chain& chain, const geometry::RobotShapes& shapes)
      : chain_(chain), shapes_(shapes) {}

  /// Obstacles that the robot can never touch, and bodies wholly within a closed mesh at the start:
  /// one sentence each, which names the problem; earlier warnings are not repeated.
  /// \param problem  with its meshes read.
  /// \param planned  the planned problem.
  std::vector<std::string> find(const Problem& problem, const PlannedProblem& planned);

 private:
  const kinematics::Chain& chain_;
  const geometry::RobotShapes& shapes_;
  std::set<std::string> told_;
};

}  // namespace kinship::guided
