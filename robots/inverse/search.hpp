#pragma once

#include <Eigen/Geometry>
#include <array>
#include <limits>

#include "robots/inverse/choice.hpp"
#include "robots/inverse/counter_generator.hpp"
#include "robots/inverse/lanes.hpp"
#include "robots/inverse/solver.hpp"

namespace kinship::inverse {

/// One call of `Solver::solve`: the starts of one pose and what came of them. Starts are counted,
/// and each draws its numbers from its own generator; a lane whose descent has ended takes the
/// next one.
class Search {
 public:
  /// \param solver, options  outlive it.
  Search(const Solver& solver, const Eigen::Isometry3d& T_base_tip, const InverseOptions& options);

  InverseSolutions run();

 private:
  /// How a number of starts descend.
  struct Effort {
    int starts = 0;
    int iterations = 0;
    LaneLimits limits = LaneLimits::Steer;
    int patience = 0;       ///< ended descents in a row without a new solution that end it
    bool anywhere = false;  ///< starts are drawn without regard to limits
  };
  enum class Ended { No, Converged, Known, Failed };

  /// Candidates of the closed form.
  void append_branches(const ClosedForm& form);
  /// Branches of the elimination, polished. \return whether it leaves nothing to be found: there
  /// are some, and each led to a solution of its own or leaves the limits.
  bool append_eliminated(const LaneElimination& arm);
  /// Whether the closed form leaves nothing to be found.
  bool knows_all(const ClosedForm& form) const;
  /// A candidate of an exact structure is verified as it is,
  void propose_exact(const double* q);
  /// one of another structure polished first.
  void propose_near(const double* q);
  void propose(const double* q);
  /// Verifies what was handed over as it is; what is off by more than rounding is polished.
  void verify_or_polish();
  /// Moves the lanes that were proposed to the pose, and verifies what got there.
  void polish();
  /// Makes a configuration, joint units, the start of a lane.
  void put(const double* q, int lane);
  void descend(const Effort& effort);
  void start(const Effort& effort, int lane);
  Ended progress(const Effort& effort, int lane);
  /// Whether the step that a lane has just made was its last: it is as near as verification asks.
  bool converged(int lane) const noexcept;
  std::array<double, kLaneJoints> configuration(int lane) const;  // joint units
  /// Whether a lane is about to end at a branch that was found before.
  bool is_known(int lane) const;
  /// Remembers a branch that leaves the limits.
  void leave_out(const double* q);
  /// Hands a configuration over to verification if it is within limits and new.
  void hand_over(std::array<double, kLaneJoints> q);
  bool is_full() const noexcept { return handed_over_ == kLanes; }
  /// Whether a lane of check_ is so near to the pose, m and rad.
  bool is_within(int lane, double tolerance) const noexcept;
  /// Keeps the configuration of a lane of check_ unless another one was found there meanwhile.
  void keep(int lane);
  /// Verifies what was handed over, and keeps what is right.
  void verify();
  bool enough() const noexcept { return found_.size() >= wanted_; }
  /// Whether so many starts in a row brought no new branch that it is no longer worth looking.
  bool complete(const Effort& effort) const noexcept;
  void find();
  InverseSolutions solutions();

  const Solver& solver_;
  const Eigen::Isometry3d T_base_transfer_;
  const std::size_t most_;     // solutions to return
  const double min_distance_;  // between them
  const std::size_t wanted_;   // to be found before the choice
  const double apart_;         // between those found
  const bool all_;             // as many as there are
  const bool exhaustive_;      // goes on where the first starts found nothing
  const bool pairs_;           // branches come in pairs
  const CounterGenerator generator_;

  LaneBatch batch_;
  LaneCheck check_;
  std::array<int, kLanes> iterations_{};
  bool near_[kLanes];  // of a solution, once
  std::uint64_t next_start_ = 0;
  int proposed_ = 0;     // lanes of batch_ that wait for the polish
  int lost_ = 0;         // of those, such as no polish made a solution
  int handed_over_ = 0;  // lanes of check_ that wait
  int idle_ = 0;         // ended descents since the last new solution
  int stationary_ = 0;   // descents that ended where the error has a minimum above 0
  Configurations found_;
  Configurations outside_;  // branches outside the limits, of an arm that is not redundant
  bool outside_limits_ = false;
  double least_squared_error_ = std::numeric_limits<double>::infinity();
};

}  // namespace kinship::inverse
