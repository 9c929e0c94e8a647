#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "robots/inverse/closed_form.hpp"
#include "robots/inverse/inverse.hpp"
#include "robots/inverse/joint_space.hpp"
#include "robots/inverse/lane_chain.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::inverse {

/// Bound on the distance of an arm's last axis from the first: a point of the last, which a pose
/// places, is never farther from a fixed point of the first than the links between them are long.
/// Within the bound a pose may still be out of reach.
class WristReach {
 public:
  /// None for a chain with a sliding joint, or whose poses do not determine the last axis.
  static std::optional<WristReach> of(const kinematics::Chain& chain);

  /// Whether no configuration, within limits or not, reaches the pose within kPoseTolerance.
  /// \param T_base_transfer  of the transfer frame in the base link.
  bool is_beyond(const Eigen::Isometry3d& T_base_transfer) const {
    return (T_base_transfer * p_transfer_wrist_ - p_base_shoulder_).norm() > reach_m_;
  }

  double reach_m() const noexcept { return reach_m_; }

 private:
  Eigen::Vector3d p_base_shoulder_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_transfer_wrist_ = Eigen::Vector3d::Zero();
  double reach_m_ = 0;
};

/// Inverse kinematics of one chain, with its precomputations, for many poses. Immutable, may be
/// shared by threads. `inverse` is the same for one pose.
class Solver {
 public:
  /// Sources of candidates. Best: a closed form if it is faster, or the elimination for an arm of
  /// six turning joints, and the descents for the gaps they leave.
  enum class Engines { Best, ClosedForm, Descents };

  /// With the fastest instruction set of this machine. The chain is not needed afterwards.
  explicit Solver(const kinematics::Chain& chain);

  /// With the kernels given; solutions differ between instruction sets by rounding only, and for
  /// one pose in thousands by a start that rounding has diverted.
  Solver(const kinematics::Chain& chain, const SimdKernels& kernels,
         Engines engines = Engines::Best);

  /// Distinct configurations that put the tip link at a pose; see `inverse`.
  /// \throws std::invalid_argument as `inverse`.
  InverseSolutions solve(const Eigen::Isometry3d& T_base_tip,
                         const InverseOptions& options = {}) const;

  /// For people, e.g. "multi-start Levenberg-Marquardt".
  std::string name() const;

  const SimdKernels& kernels() const noexcept { return kernels_; }
  const LaneChain& lanes() const noexcept { return lanes_; }
  const LaneArm& arm() const noexcept { return arm_; }
  const JointSpace& space() const noexcept { return space_; }
  const ClosedForm* closed_form() const noexcept { return closed_ ? &*closed_ : nullptr; }
  const LaneElimination* elimination() const noexcept {
    return elimination_ ? &*elimination_ : nullptr;
  }
  const Eigen::Isometry3d& T_tip_transfer() const noexcept { return T_tip_transfer_; }
  /// Whether joints can move while the transfer frame stays; see is_redundant.
  bool redundant() const noexcept { return redundant_; }
  /// Whether some joints repeat others; see has_repeated_joints.
  bool repeats_joints() const noexcept { return repeats_joints_; }
  /// Whether the pose is too far away for a chain of this length.
  bool beyond_reach(const Eigen::Isometry3d& T_base_transfer) const;

 private:
  SimdKernels kernels_;
  LaneChain lanes_;
  LaneArm arm_;
  JointSpace space_;
  bool redundant_;
  bool repeats_joints_;
  std::optional<ClosedForm> closed_;
  std::optional<LaneElimination> elimination_;
  Eigen::Isometry3d T_tip_transfer_;
  double reach_m_;
  std::optional<WristReach> wrist_reach_;
  Eigen::Vector3d p_base_first_joint_;
};

}  // namespace kinship::inverse
