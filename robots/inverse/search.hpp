#pragma once

#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "robots/inverse/counter_generator.hpp"
#include "robots/inverse/joint_space.hpp"
#include "robots/inverse/lanes.hpp"
#include "robots/inverse/solver.hpp"

namespace kinship::inverse {

/// Configurations of one chain, one after the other.
class Configurations {
 public:
  explicit Configurations(Eigen::Index dof) : dof_(static_cast<std::size_t>(dof)) {}

  std::size_t size() const noexcept { return values_.size() / dof_; }
  bool empty() const noexcept { return values_.empty(); }
  const double* operator[](std::size_t i) const noexcept { return values_.data() + i * dof_; }
  void add(const double* q) { values_.insert(values_.end(), q, q + dof_); }
  void swap(std::size_t a, std::size_t b) noexcept;

  /// dof x size()
  Eigen::MatrixXd matrix() const;

 private:
  std::size_t dof_;
  std::vector<double> values_;
};

/// Whether a configuration is at least `distance` from all of `from`.
bool is_apart(const JointSpace& space, const Configurations& from, const double* q,
              double distance) noexcept;

/// Takes, in uniformly shuffled order, each configuration at least `distance` from those taken
/// before, until there are `most`.
Configurations chosen(const JointSpace& space, Configurations all, std::size_t most,
                      double distance, CounterGenerator generator);

/// One call of `Solver::solve`: the starts for one pose and their results. Starts are counted, and
/// each draws its numbers from its own generator; a lane whose descent has ended takes the next
/// start.
class Search {
 public:
  /// \param solver, options  outlive it.
  Search(const Solver& solver, const Eigen::Isometry3d& T_base_tip, const InverseOptions& options);

  InverseSolutions run();

 private:
  /// Options of a number of descents.
  struct Effort {
    int starts = 0;
    int iterations = 0;
    LaneLimits limits = LaneLimits::Steer;
    int patience = 0;       ///< ends after so many descents in a row without a new solution
    bool anywhere = false;  ///< draws starts without regard to limits
  };
  enum class Ended { No, Converged, Known, Failed };

  /// Candidates of the closed form.
  void append_branches(const ClosedForm& form);
  /// The same with values of the locked joints side by side.
  void append_lanes(const ClosedForm& form);
  /// Candidates of the closed form at values of the locked joints.
  void append_at(const ClosedForm& form, std::span<const double> locked);
  /// Branches of the elimination, polished. \return whether they are complete: there are some, and
  /// each led to a distinct solution or leaves the limits.
  bool append_eliminated(const LaneElimination& arm);
  /// Whether the closed form has given all solutions.
  bool knows_all(const ClosedForm& form) const;
  /// Verifies a candidate of an exact structure without a polish.
  void propose_exact(const double* q);
  /// Polishes a candidate of another structure before verification.
  void propose_near(const double* q);
  void propose(const double* q);
  /// Verifies the candidates handed over; polishes those off by more than rounding.
  void verify_or_polish();
  /// Moves the proposed lanes to the pose, and verifies those that converged.
  void polish();
  /// Makes a configuration, joint units, the start of a lane.
  void put(const double* q, int lane);
  void descend(const Effort& effort);
  void start(const Effort& effort, int lane);
  Ended progress(const Effort& effort, int lane);
  /// Whether a lane has converged, to the accuracy of verification.
  bool converged(int lane) const noexcept;
  std::array<double, kLaneJoints> configuration(int lane) const;  // joint units
  /// Whether a lane approaches a branch that was found before.
  bool is_known(int lane) const;
  /// Remembers a branch that leaves the limits.
  void leave_out(const double* q);
  /// Hands a configuration over to verification if it is within limits and new.
  void hand_over(std::array<double, kLaneJoints> q);
  bool is_full() const noexcept { return handed_over_ == kLanes; }
  /// Whether a lane of check_ is within `tolerance` of the pose, m and rad.
  bool is_within(int lane, double tolerance) const noexcept;
  /// Keeps the configuration of a lane of check_ unless one near it was found meanwhile.
  void keep(int lane);
  /// Verifies the candidates handed over, and keeps the solutions.
  void verify();
  /// Solutions, and the candidates that may become some.
  std::size_t promised() const noexcept {
    return found_.size() + static_cast<std::size_t>(handed_over_ + proposed_);
  }
  bool enough() const noexcept { return found_.size() >= wanted_; }
  /// Whether so many starts in a row gave no new branch that further ones are not worthwhile.
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
  int lost_ = 0;         // proposed ones that no polish made a solution
  int handed_over_ = 0;  // lanes of check_ that wait
  int idle_ = 0;         // ended descents since the last new solution
  int stationary_ = 0;   // descents that ended where the error has a minimum above 0
  Configurations found_;
  Configurations outside_;  // branches outside the limits, of an arm that is not redundant
  bool outside_limits_ = false;
  double least_squared_error_ = std::numeric_limits<double>::infinity();
};

}  // namespace kinship::inverse
