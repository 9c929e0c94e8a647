#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>

#include "robots/kinematics/chain.hpp"
#include "robots/kinematics/same_arm.hpp"
#include "server/transfer/target_robot.hpp"

namespace kinship::transfer {

/// A source and a target robot, compared and prepared once for all paths between them. May be
/// shared between threads.
class ArmPair {
 public:
  /// \param source  outlives the pair.
  ArmPair(const kinematics::Chain& source, std::shared_ptr<const TargetArm> target);
  /// The same with a target of its own.
  ArmPair(const kinematics::Chain& source, const kinematics::Chain& target);

  const kinematics::Chain& source() const noexcept { return source_; }
  const kinematics::Chain& target() const noexcept { return target_->chain(); }
  kinematics::ArmLikeness likeness() const noexcept { return likeness_; }
  const inverse::Solver& target_solver() const noexcept { return target_->solver(); }
  const inverse::Descent& target_descent() const noexcept { return target_->descent(); }

  /// Points of the target's shape; see shape_marks.
  const std::optional<inverse::LaneMarks>& target_marks() const noexcept {
    return target_->marks();
  }

  /// Whether waypoints are taken over between robots with these bases: the same arm at the same
  /// place (within 1e-9 m and rad).
  bool takes_over(const Eigen::Isometry3d& T_target_source) const;

 private:
  const kinematics::Chain& source_;
  std::shared_ptr<const TargetArm> target_;  // shared by the pairs of all sources
  kinematics::ArmLikeness likeness_;
};

}  // namespace kinship::transfer
