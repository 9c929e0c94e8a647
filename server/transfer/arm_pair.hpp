#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/kinematics/same_arm.hpp"

namespace kinship::transfer {

/// A source and a target robot, compared and prepared once for all paths between them. May be
/// shared between threads.
class ArmPair {
 public:
  /// \param source, target  outlive the pair.
  ArmPair(const kinematics::Chain& source, const kinematics::Chain& target);

  const kinematics::Chain& source() const noexcept { return source_; }
  const kinematics::Chain& target() const noexcept { return target_; }
  kinematics::ArmLikeness likeness() const noexcept { return likeness_; }
  const inverse::Solver& target_solver() const noexcept { return target_solver_; }
  const inverse::Descent& target_descent() const noexcept { return target_descent_; }

  /// Where the target's shape is looked at; see shape_marks.
  const std::optional<inverse::LaneMarks>& target_marks() const noexcept { return target_marks_; }

  /// Whether waypoints are taken over between robots whose bases stand like this: the same arm at
  /// the same place (within 1e-9 m and rad).
  bool takes_over(const Eigen::Isometry3d& T_target_source) const;

 private:
  const kinematics::Chain& source_;
  const kinematics::Chain& target_;
  kinematics::ArmLikeness likeness_;
  inverse::Descent target_descent_;
  inverse::Solver target_solver_;
  std::optional<inverse::LaneMarks> target_marks_;
};

}  // namespace kinship::transfer
