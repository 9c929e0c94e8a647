#pragma once

#include <Eigen/Geometry>
#include <optional>

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

}  // namespace kinship::inverse
