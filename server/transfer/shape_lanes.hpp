#pragma once

#include <Eigen/Geometry>
#include <array>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/lanes.hpp"
#include "server/transfer/arm_pair.hpp"
#include "server/transfer/arm_shape.hpp"

namespace kinship::transfer {

/// Configurations of a pair's target, moved side by side: each lane has a pose to be at, a shape to
/// look like and a configuration. Sets of lanes are bits. Not shared between threads.
class ShapeLanes {
 public:
  static constexpr int kCount = inverse::kLanes;

  /// \param pair  outlives it.
  explicit ShapeLanes(const ArmPair& pair);

  /// \param T_base_transfer  in the target's base link.
  /// \param wanted           shape of the source, in the target's base link.
  void aim(int lane, const Eigen::Isometry3d& T_base_transfer, const ArmShape& wanted);
  void put(int lane, const inverse::JointVector& q);
  inverse::JointVector at(int lane) const;

  /// Descends to the poses; no joint leaves its limits. \return the lanes that got there; the
  /// others stay where they were.
  unsigned reach(unsigned lanes);

  /// Moves configurations that are at their poses through the self-motion towards their shapes, in
  /// at most `steps`; see pull_to_shape.
  void pull(unsigned lanes, int steps);

  /// How far the shape of a lane was from the wanted one at the end of the last pull, m.
  double distance_m(int lane) const { return distance_m_[static_cast<std::size_t>(lane)]; }

  /// How far the shapes of configurations (one per column) are from a wanted one, m. What stands in
  /// the lanes stays.
  Eigen::VectorXd distances_m(const Eigen::MatrixXd& configurations, const ArmShape& wanted) const;

  /// Those of the lanes at whose poses `configurations` (one column per lane) put the transfer
  /// frame, by forward kinematics of the target within kPoseTolerance.
  unsigned verified(unsigned lanes, const Eigen::MatrixXd& configurations);

 private:
  unsigned descend(unsigned lanes);
  void pull_one(int lane, int steps);

  const ArmPair& pair_;
  const inverse::Solver& solver_;
  inverse::LaneBatch batch_;
  inverse::LanePull pull_;
  inverse::LaneCheck check_;
  std::array<Eigen::Isometry3d, kCount> T_base_transfer_;
  std::array<ArmShape, kCount> wanted_;
  std::array<inverse::JointVector, kCount> q_;
  std::array<double, kCount> distance_m_{};
};

}  // namespace kinship::transfer
