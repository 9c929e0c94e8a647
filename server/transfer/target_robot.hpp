#pragma once

#include <memory>
#include <optional>

#include "robots/collision/robot_solids.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/chain.hpp"
#include "server/transfer/filters.hpp"

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

/// Solids around a robot's meshes, asked before the meshes: what is apart for them is apart.
struct MeshCovers {
  collision::RobotSolids solids;
  /// Links that are compared by their meshes and not by these solids; nothing: there are none.
  std::optional<collision::RobotSolids> uncovered;
};

/// Preparation common to all transfers to one robot, from any source and at any placement.
/// Immutable, may be shared between threads.
struct TargetRobot {
  /// \throws Failure(InvalidInput), see RobotSolids.
  /// \param covers  null, or the shapes with solids around their meshes.
  TargetRobot(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
              const geometry::RobotShapes* covers = nullptr);

  std::shared_ptr<const TargetArm> arm;  ///< pairs of arms share it
  collision::RobotSolids solids;         ///< for its filters
  std::optional<MeshCovers> covers;      ///< asked first
};

/// Keeps the configurations in which the robot does not touch itself, as collision_filter().
ConfigurationFilter self_filter(const TargetRobot& robot);

}  // namespace kinship::transfer
