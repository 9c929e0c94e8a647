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

/// Lanes in the order in which they came.
template <int kCapacity>
class LaneQueue {
 public:
  int size() const noexcept { return size_; }
  void push(int lane) { lanes_[static_cast<std::size_t>((first_ + size_++) % kCapacity)] = lane; }
  int pop() {
    const int lane = lanes_[static_cast<std::size_t>(first_)];
    first_ = (first_ + 1) % kCapacity;
    --size_;
    return lane;
  }

 private:
  std::array<int, static_cast<std::size_t>(kCapacity)> lanes_{};
  int first_ = 0, size_ = 0;
};

/// Configurations of a pair's target, moved side by side: each lane has a pose to be at, a shape to
/// look like and a configuration, and is given something to do of its own, at any time. What
/// becomes of it does not depend on the other lanes. Not shared between threads.
///
/// There are more lanes than the kernels take at once: as many for the one that descends, as many
/// that wait for the one that pulls, and as many again that have ended, so that all have enough.
class ShapeLanes {
 public:
  static constexpr int kCount = 4 * inverse::kLanes;

  /// What a lane is at.
  enum class State : std::uint8_t {
    Idle,       ///< nothing
    Reaching,   ///< descends to its pose from the one before, or waits to
    Measuring,  ///< is at its pose and waits for the kernel that pulls
    Settling,   ///< descends back to its pose, pulled, or waits to
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

  /// Works until the lanes at work no longer fill the kernels and a share of all has ended, so that
  /// others can take their place.
  /// \return false: every lane is idle.
  bool run();

  State state(int lane) const { return states_[static_cast<std::size_t>(lane)]; }
  bool is_idle(int lane) const { return state(lane) == State::Idle; }
  bool has_ended(int lane) const {
    return state(lane) == State::Arrived || state(lane) == State::Failed;
  }
  /// Leaves a lane that has ended without anything to do.
  void rest(int lane) { set(lane, State::Idle); }

  /// Of each lane whether it is idle or has arrived and `configurations` (one column per lane) put
  /// the transfer frame at its pose, by forward kinematics of the target within kPoseTolerance.
  std::array<bool, kCount> verified(const Eigen::MatrixXd& configurations);

 private:
  /// How far a lane has come with it.
  struct Work {
    double most_motion = 0;
    inverse::JointVector start;    ///< before the step
    inverse::JointVector reached;  ///< where it came to its pose
    inverse::JointVector settled;  ///< where the pull came back to it
    inverse::JointVector raw;      ///< where the kernels are, in their values
    int iterations = 0;            ///< of the descent
    int steps_left = 0;            ///< of the pull
    double distance_m = 0;         ///< of the shapes
  };
  static constexpr int kSeats = inverse::kLanes;
  static constexpr int kEmpty = -1;  // seat

  Work& work(int lane) { return work_[static_cast<std::size_t>(lane)]; }
  void set(int lane, State state) {
    State& before = states_[static_cast<std::size_t>(lane)];
    --counts_[static_cast<std::size_t>(before)];
    ++counts_[static_cast<std::size_t>(state)];
    before = state;
  }
  /// Lanes in a state.
  int count(State state) const { return counts_[static_cast<std::size_t>(state)]; }
  /// Lets a lane wait for a kernel.
  void begin_descent(int lane, State state);
  void begin_measuring(int lane);
  /// Gives seats of the kernel that descends to lanes that wait for one.
  void seat();
  /// One iteration of the lanes that have a seat.
  void descend();
  void reached(int lane);
  void settled(int lane);
  void start_pull(int lane, int steps);
  /// One step of as many lanes that are pulled as the kernel takes: measures their shapes and moves
  /// on from there.
  void measure();
  void measured(int lane, int seat);
  /// A lane that was pulled too far goes back to where it came to its pose.
  void end_pull(int lane);

  const ArmPair& pair_;
  const inverse::Solver& solver_;
  inverse::LaneBatch batch_;
  inverse::LanePull pull_;
  inverse::LaneCheck check_;
  std::array<int, kSeats> seats_;  // lanes that descend, or kEmpty
  LaneQueue<kCount> to_descend_, to_measure_;
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
