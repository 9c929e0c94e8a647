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

/// A queue of lanes, first in, first out.
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

/// Configurations of a pair's target, moved side by side: each lane has a target pose, a wanted
/// shape and a configuration, and gets tasks of its own, at any time. Its results do not depend on
/// the other lanes. Not shared between threads.
///
/// There are more lanes than the kernels take at once: enough for the one that descends, for the
/// one that pulls, and for lanes that have ended, so that the kernels stay full.
class ShapeLanes {
 public:
  static constexpr int kCount = 4 * inverse::kLanes;

  /// State of a lane.
  enum class State : std::uint8_t {
    Idle,       ///< no task
    Reaching,   ///< descends to its pose from the previous one, or waits for that
    Measuring,  ///< is at its pose and waits for the kernel that pulls
    Settling,   ///< descends back to its pose after a pull, or waits for that
    Arrived,    ///< has completed its task
    Failed,     ///< could not complete it; its configuration is unchanged
  };

  /// \param pair  outlives it.
  explicit ShapeLanes(const ArmPair& pair);

  /// \param T_base_transfer  in the target's base link.
  /// \param wanted           shape of the source, in the target's base link.
  void aim(int lane, const Eigen::Isometry3d& T_base_transfer, const ArmShape& wanted);
  void put(int lane, const inverse::JointVector& q);
  const inverse::JointVector& at(int lane) const { return q_[static_cast<std::size_t>(lane)]; }

  /// Task of a lane: descend to its pose, which fails if a joint would have to leave its limits or
  /// the lane to move by more than `most_motion` (joint units), then pull as begin_pull does,
  /// within the same motion.
  void begin_step(int lane, double most_motion, int steps);

  /// Task of a lane at its pose: move through the self-motion towards its shape, in at most
  /// `steps`; see pull_alone.
  void begin_pull(int lane, int steps);

  /// Works until the working lanes no longer fill the kernels and enough lanes have ended that new
  /// tasks can replace them.
  /// \return false: every lane is idle.
  bool run();

  State state(int lane) const { return states_[static_cast<std::size_t>(lane)]; }
  bool is_idle(int lane) const { return state(lane) == State::Idle; }
  bool has_ended(int lane) const {
    return state(lane) == State::Arrived || state(lane) == State::Failed;
  }
  /// Makes a lane that has ended idle.
  void rest(int lane) { set(lane, State::Idle); }

  /// For each lane, whether it is idle, or has arrived and its column of `configurations` puts the
  /// transfer frame at its pose, by forward kinematics of the target within kPoseTolerance.
  std::array<bool, kCount> verified(const Eigen::MatrixXd& configurations);

 private:
  /// Progress of a lane in its task.
  struct Work {
    double most_motion = 0;
    inverse::JointVector start;    ///< before the step
    inverse::JointVector reached;  ///< first at its pose
    inverse::JointVector settled;  ///< back at its pose after the pull
    inverse::JointVector raw;      ///< current, in the kernels' values
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
  /// Queues a lane for a kernel.
  void begin_descent(int lane, State state);
  void begin_measuring(int lane);
  /// Gives free seats of the descending kernel to waiting lanes.
  void seat();
  /// Runs one iteration of the lanes that have a seat.
  void descend();
  void reached(int lane);
  void settled(int lane);
  void start_pull(int lane, int steps);
  /// Runs one pull step of as many lanes as the kernel takes: measures their shapes and moves them.
  void measure();
  void measured(int lane, int seat);
  /// Ends the pull of a lane; one pulled too far returns to its first configuration at its pose.
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

/// Distances of the shapes of configurations (one per column) of a pair's target from a wanted one,
/// m; computed by the kernels.
Eigen::VectorXd shape_distances_m(const ArmPair& pair, const Eigen::MatrixXd& configurations,
                                  const ArmShape& wanted);

}  // namespace kinship::transfer
