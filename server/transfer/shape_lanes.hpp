#pragma once

#include <Eigen/Geometry>
#include <array>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/lanes.hpp"
#include "server/transfer/arm_pair.hpp"
#include "server/transfer/arm_shape.hpp"

namespace kinship::transfer {

/// Sets of lanes are bits.
inline unsigned lane_bit(int lane) { return 1U << static_cast<unsigned>(lane); }
inline bool has_lane(unsigned lanes, int lane) { return (lanes & lane_bit(lane)) != 0; }

/// Configurations of a pair's target, moved side by side: each lane has a pose to be at, a shape to
/// look like and a configuration, and is given something to do of its own, at any time. What
/// becomes of it does not depend on the other lanes. Sets of lanes are bits. Not shared between
/// threads.
class ShapeLanes {
 public:
  static constexpr int kCount = inverse::kLanes;

  /// \param pair  outlives it.
  explicit ShapeLanes(const ArmPair& pair);

  /// \param T_base_transfer  in the target's base link.
  /// \param wanted           shape of the source, in the target's base link.
  void aim(int lane, const Eigen::Isometry3d& T_base_transfer, const ArmShape& wanted);
  void put(int lane, const inverse::JointVector& q);
  const inverse::JointVector& at(int lane) const { return q_[static_cast<std::size_t>(lane)]; }

  /// What a lane is to do: descend to its pose, which fails if a joint would have to leave its
  /// limits or the lane to move by more than `most_motion` (joint units), and then as begin_pull,
  /// where that leads no farther. A lane that fails stays where it was.
  void begin_step(int lane, double most_motion, int steps);

  /// What a lane is to do that is at its pose: move through the self-motion towards its shape, in
  /// at most `steps`; see pull_to_shape.
  void begin_pull(int lane, int steps);

  /// Lanes that have done what they were to do, or could not.
  struct Ended {
    unsigned arrived = 0, failed = 0;
  };

  /// Works until a share of the lanes at work have ended, so that others can take their place.
  Ended run();

  /// begin_pull for some lanes, with all that follows from it.
  void pull(unsigned lanes, int steps);

  /// How far the shape of a redundant arm was from the wanted one at the end of the last pull, m.
  double distance_m(int lane) const { return work_[static_cast<std::size_t>(lane)].distance_m; }

  /// Those of the lanes at whose poses `configurations` (one column per lane) put the transfer
  /// frame, by forward kinematics of the target within kPoseTolerance.
  unsigned verified(unsigned lanes, const Eigen::MatrixXd& configurations);

 private:
  /// What a lane is at.
  struct Work {
    double most_motion = 0;
    inverse::JointVector start;    ///< before the step
    inverse::JointVector reached;  ///< where it came to its pose
    inverse::JointVector settled;  ///< where the pull came back to it
    int iterations = 0;            ///< of the descent
    int steps_left = 0;            ///< of the pull
    double distance_m = 0;
  };

  Work& work(int lane) { return work_[static_cast<std::size_t>(lane)]; }
  /// One iteration of the lanes that descend.
  void descend(Ended& ended);
  void reached(int lane, Ended& ended);
  void settled(int lane);
  void start_pull(int lane, int steps);
  /// One step of the lanes that are pulled: measures their shapes and moves on from there.
  void measure();
  void end_pulls(Ended& ended);

  const ArmPair& pair_;
  const inverse::Solver& solver_;
  inverse::LaneBatch batch_;
  inverse::LanePull pull_;
  inverse::LaneCheck check_;
  std::array<Eigen::Isometry3d, kCount> T_base_transfer_;
  std::array<ArmShape, kCount> wanted_;
  std::array<inverse::JointVector, kCount> q_;
  std::array<Work, kCount> work_;
  unsigned reaching_ = 0;   // descend to a pose from the one before
  unsigned settling_ = 0;   // descend back to it, pulled
  unsigned measuring_ = 0;  // wait for the kernel that pulls
  unsigned pulled_ = 0;     // wait for end_pulls
};

/// How far the shapes of configurations (one per column) of a pair's target are from a wanted one,
/// m; measured by the kernels.
Eigen::VectorXd shape_distances_m(const ArmPair& pair, const Eigen::MatrixXd& configurations,
                                  const ArmShape& wanted);

}  // namespace kinship::transfer
