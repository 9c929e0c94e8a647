#pragma once

#include <memory>
#include <optional>

#include "robots/collision/robot_solids.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::transfer {

/// The arm of a target robot, prepared once for whatever comes to it. Immutable, may be shared
/// between threads.
class TargetArm {
 public:
  explicit TargetArm(kinematics::Chain chain);

  const kinematics::Chain& chain() const noexcept { return chain_; }
  const inverse::Solver& solver() const noexcept { return solver_; }
  const inverse::Descent& descent() const noexcept { return descent_; }
  /// Where the arm's shape is looked at; see shape_marks.
  const std::optional<inverse::LaneMarks>& marks() const noexcept { return marks_; }

 private:
  kinematics::Chain chain_;
  inverse::Descent descent_;
  inverse::Solver solver_;
  std::optional<inverse::LaneMarks> marks_;
};

/// What all transfers to one robot have in common, whatever they come from and wherever it stands.
/// Immutable, may be shared between threads.
struct TargetRobot {
  /// \throws Failure(InvalidInput) as RobotSolids says.
  TargetRobot(const kinematics::Chain& chain, const geometry::RobotShapes& shapes);

  std::shared_ptr<const TargetArm> arm;  ///< pairs of arms share it
  collision::RobotSolids solids;         ///< for its filters
};

}  // namespace kinship::transfer
