#pragma once

#include <memory>
#include <optional>

#include "robots/collision/robot_solids.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::transfer {

/// The arm of a target robot, prepared once for all transfers to it. Immutable, may be shared
/// between threads.
class TargetArm {
 public:
  explicit TargetArm(kinematics::Chain chain);

  const kinematics::Chain& chain() const noexcept { return chain_; }
  const inverse::Solver& solver() const noexcept { return solver_; }
  const inverse::Descent& descent() const noexcept { return descent_; }
  /// Points of the arm's shape; see shape_marks.
  const std::optional<inverse::LaneMarks>& marks() const noexcept { return marks_; }

 private:
  kinematics::Chain chain_;
  inverse::Descent descent_;
  inverse::Solver solver_;
  std::optional<inverse::LaneMarks> marks_;
};

/// Preparation common to all transfers to one robot, from any source and at any placement.
/// Immutable, may be shared between threads.
struct TargetRobot {
  /// \throws Failure(InvalidInput), see RobotSolids.
  TargetRobot(const kinematics::Chain& chain, const geometry::RobotShapes& shapes);

  std::shared_ptr<const TargetArm> arm;  ///< pairs of arms share it
  collision::RobotSolids solids;         ///< for its filters
};

}  // namespace kinship::transfer
