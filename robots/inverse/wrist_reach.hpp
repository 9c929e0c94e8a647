#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "robots/kinematics/chain.hpp"

namespace kinship::inverse {

/// How far the last axis of an arm gets from the first: a point of the one, which a pose places, is
/// never farther from a point of the other, which stands still, than the links between them are
/// long. A bound only: within it a pose may be out of reach all the same.
class WristReach {
 public:
  /// None for a chain with a sliding joint, or whose poses leave open where the last axis lies.
  static std::optional<WristReach> of(const kinematics::Chain& chain);

  /// Whether no configuration, within limits or not, comes to the pose within kPoseTolerance.
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

}  // namespace kinship::inverse
