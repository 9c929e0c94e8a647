#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/lanes.hpp"
#include "server/transfer/arm_pair.hpp"
#include "server/transfer/arm_shape.hpp"

namespace kinship::transfer {

/// Configurations of a pair's target, moved side by side: each lane has a pose to be at, a shape to
/// look like and a configuration, and is given something to do of its own, at any time. What
/// becomes of it does not depend on the other lanes. Not shared between threads.
class ShapeLanes {
 public:
  static constexpr int kCount = inverse::kLanes;

  /// What a lane is at.
  enum class State : std::uint8_t {
    Idle,       ///< nothing
    Reaching,   ///< descends to its pose from the one before
    Measuring,  ///< is at its pose and waits for the kernel that pulls
    Settling,   ///< descends back to its pose, pulled
    Arrived,    ///< has done what it was to do
    Failed,     ///< could not, and stayed where it was
  };

  /// \param pair  outlives it.
  explicit ShapeLanes(const ArmPair& pair);

  /// \param T_base_transfer  in the target's base link.
  /// \param wanted           shape of the source, in the target's base link.
  void aim(int lane, const Eigen::Isometry3d& T_base_transfer, const ArmShape& wanted);
  void put(int lane, const inverse::JointVector& q);
  const inverse::JointVector& at(int lane) const { return q_[static_cast<std::size_t>(lane)]; }

  /// What a lane is to do: descend to its pose, which fails if a joint would have to leave its
  /// limits or the lane to move by more than `most_motion` (joint units), and then as begin_pull,
  /// where that leads no farther.
  void begin_step(int lane, double most_motion, int steps);

  /// What a lane is to do that is at its pose: move through the self-motion towards its shape, in
  /// at most `steps`; see pull_alone.
  void begin_pull(int lane, int steps);

  /// Works until a share of the lanes at work have ended, so that others can take their place.
  /// \return false: every lane is idle.
  bool run();

  State state(int lane) const { return states_[static_cast<std::size_t>(lane)]; }
  bool is_idle(int lane) const { return state(lane) == State::Idle; }
  bool has_ended(int lane) const {
    return state(lane) == State::Arrived || state(lane) == State::Failed;
  }
  /// Leaves a lane that has ended without anything to do.
  void rest(int lane) { set(lane, State::Idle); }

  /// Of each lane whether `configurations` (one column per lane) put the transfer frame at its
  /// pose, by forward kinematics of the target within kPoseTolerance.
  std::array<bool, kCount> verified(const Eigen::MatrixXd& configurations);

 private:
  /// How far a lane has come with it.
  struct Work {
    double most_motion = 0;
    inverse::JointVector start;    ///< before the step
    inverse::JointVector reached;  ///< where it came to its pose
    inverse::JointVector settled;  ///< where the pull came back to it
    int iterations = 0;            ///< of the descent
    int steps_left = 0;            ///< of the pull
    double distance_m = 0;         ///< of the shapes
  };

  Work& work(int lane) { return work_[static_cast<std::size_t>(lane)]; }
  void set(int lane, State state) {
    State& before = states_[static_cast<std::size_t>(lane)];
    --counts_[static_cast<std::size_t>(before)];
    ++counts_[static_cast<std::size_t>(state)];
    before = state;
  }
  /// Lanes in a state.
  int count(State state) const { return counts_[static_cast<std::size_t>(state)]; }
  /// One iteration of the lanes that descend.
  void descend();
  void reached(int lane);
  void settled(int lane);
  void start_pull(int lane, int steps);
  /// One step of the lanes that are pulled: measures their shapes and moves on from there.
  void measure();
  /// A lane that was pulled too far goes back to where it came to its pose.
  void end_pull(int lane);

  const ArmPair& pair_;
  const inverse::Solver& solver_;
  inverse::LaneBatch batch_;
  inverse::LanePull pull_;
  inverse::LaneCheck check_;
  std::array<Eigen::Isometry3d, kCount> T_base_transfer_;
  std::array<ArmShape, kCount> wanted_;
  std::array<inverse::JointVector, kCount> q_;
  std::array<Work, kCount> work_;
  std::array<State, kCount> states_{};
  std::array<int, static_cast<std::size_t>(State::Failed) + 1> counts_ = {kCount};  // per state
};

/// How far the shapes of configurations (one per column) of a pair's target are from a wanted one,
/// m; measured by the kernels.
Eigen::VectorXd shape_distances_m(const ArmPair& pair, const Eigen::MatrixXd& configurations,
                                  const ArmShape& wanted);

}  // namespace kinship::transfer
