#include "robots/inverse/search.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/elimination.hpp"

namespace kinship::inverse {
namespace {

constexpr double kSamePoint = 1e-3;  // joint units: closer ones are the same solution
constexpr std::size_t kMaxSolutions = 1000;
constexpr std::size_t kMaxFound = 64;  // of an arm that is not redundant, before the choice
constexpr int kIterations = 10;        // measured: a new start is worth more than an eleventh,
constexpr int kMoreIterations = 5;     // unless the error is below the first of these; then,
constexpr double kPromising[] = {1e-3, 1e-5};  // as often again, below the second (squared)
constexpr int kPatientIterations = 40;         // for poses that no ordinary start has solved
constexpr int kPatientStarts = 16;
constexpr int kHoldingStarts = 32;
constexpr int kCornerStarts = 512;  // the same where joints move like others, and end at limits
constexpr int kFewestStarts = 32;
constexpr int kStartsPerSolution = 4;
constexpr int kMaxStarts = 4000;
constexpr int kFirstStarts = 16;
constexpr int kDiagnosticStarts = 8;
constexpr int kSaturated = 96;        // ended descents in a row without a new solution
constexpr int kBranchPatience = 52;   // the same, for the branches of an arm that is not redundant
constexpr int kEvenPatience = 20;     // the same where branches come in pairs: none alone is known,
constexpr int kOddPatience = 100;     // and one is missing for certain
constexpr double kConverged = 1e-12;  // squared error before the last step, which squares it again
constexpr double kSettled = 1e-9;     // squared step of a lane that converges so fast
constexpr int kFewestLocks = 8;       // random values of the locked joints
constexpr int kLaneLockValues = 64;   // the same where they go side by side
constexpr int kIdleLocks = 24;        // in a row without a new solution
constexpr int kPolishSteps = 8;
constexpr double kPolished = 1e-9;    // m and rad: singular poses, which exceed it, take a polish
constexpr double kKnown = 0.1;        // joint units: a descent that near to a branch will end there
constexpr double kNear = 0.1;         // task error worth more patience
constexpr double kFar = 1e-2;         // task error of a pose that is not just hard
constexpr double kStationary = 1e-4;  // squared step by squared error
constexpr int kPairedJoints = 6;      // of a non-redundant arm whose branches come in pairs
constexpr std::uint64_t kChoice = ~std::uint64_t{0};  // the attempt that shuffles

/// Whether a pose is reached in an even number of ways, limits aside.
bool come_in_pairs(const LaneChain& chain) {
  return chain.dof == kPairedJoints && chain.rows == kPairedJoints &&
         std::none_of(chain.joints, chain.joints + chain.dof,
                      [](const LaneJoint& joint) { return joint.slides; });
}

}  // namespace

void Configurations::swap(std::size_t a, std::size_t b) noexcept {
  if (a != b)
    std::swap_ranges(values_.data() + a * dof_, values_.data() + (a + 1) * dof_,
                     values_.data() + b * dof_);
}

Eigen::MatrixXd Configurations::matrix() const {
  return Eigen::Map<const Eigen::MatrixXd>(values_.data(), static_cast<Eigen::Index>(dof_),
                                           static_cast<Eigen::Index>(size()));
}

bool is_apart(const JointSpace& space, const Configurations& from, const double* q,
              double distance) noexcept {
  for (std::size_t i = 0; i < from.size(); ++i)
    if (space.squared_distance(q, from[i], distance * distance) < distance * distance)
      return false;
  return true;
}

Configurations chosen(const JointSpace& space, Configurations all, std::size_t most,
                      double distance, CounterGenerator generator) {
  Configurations taken(space.dof());
  for (std::size_t i = 0; i < all.size() && taken.size() < most; ++i) {
    const std::size_t left = all.size() - i;
    const auto draw = static_cast<std::size_t>(generator.uniform() * static_cast<double>(left));
    all.swap(i, i + std::min(draw, left - 1));
    if (is_apart(space, taken, all[i], distance))
      taken.add(all[i]);
  }
  return taken;
}

Search::Search(const Solver& solver, const Eigen::Isometry3d& T_base_tip,
               const InverseOptions& options)
    : solver_(solver),
      T_base_transfer_(T_base_tip * solver.T_tip_transfer()),
      most_(options.max_solutions == 0
                ? kMaxSolutions
                : std::min(static_cast<std::size_t>(options.max_solutions), kMaxSolutions)),
      min_distance_(std::max(options.min_distance, kSamePoint)),
      wanted_(solver.redundant() || options.max_solutions == 0 ? most_
                                                               : std::max(most_, kMaxFound)),
      apart_(solver.redundant() ? min_distance_ : kSamePoint),
      all_(options.max_solutions == 0),
      exhaustive_(options.exhaustive),
      pairs_(!solver.redundant() && come_in_pairs(solver.lanes())),
      generator_(options.seed, T_base_tip),
      found_(solver.space().dof()),
      outside_(solver.space().dof()) {
  const double length_m = solver.lanes().length_m;
  for (int i = 0; i < 12; ++i) {
    const double value = i < 9 ? T_base_transfer_(i / 3, i % 3) : T_base_transfer_(i - 9, 3);
    std::fill_n(batch_.target[i], kLanes, i < 9 ? value : value / length_m);
    std::fill_n(check_.target[i], kLanes, value);
  }
  for (int j = 0; j < solver.lanes().dof; ++j) {
    std::fill_n(batch_.q[j], kLanes, 0);
    std::fill_n(check_.q[j], kLanes, 0);
  }
}

InverseSolutions Search::run() {
  if (!solver_.beyond_reach(T_base_transfer_))
    find();
  return solutions();
}

void Search::find() {
  if (const ClosedForm* form = solver_.closed_form()) {
    append_branches(*form);
    if (enough() || knows_all(*form))
      return;
  }
  if (const LaneElimination* arm = solver_.elimination())
    if (append_eliminated(*arm) && !all_)
      return;
  const LaneLimits steer = solver_.redundant() ? LaneLimits::Steer : LaneLimits::Ignore;
  const int starts =
      all_ ? kMaxStarts : std::max(kFewestStarts, kStartsPerSolution * static_cast<int>(wanted_));
  const int patience = all_ ? kSaturated : solver_.redundant() ? starts : kBranchPatience;
  descend({kFirstStarts, kIterations, steer, kFirstStarts});
  if (enough())
    return;
  if (found_.empty() && !outside_limits_) {  // are limits in the way?
    descend({kDiagnosticStarts, kIterations, LaneLimits::Ignore, kDiagnosticStarts, true});
    if (found_.empty() && least_squared_error_ > kNear * kNear)
      return;
  }
  if (found_.empty() && !exhaustive_)
    return;
  descend({starts - kFirstStarts, kIterations, steer, patience});
  if (found_.empty()) {
    stationary_ = 0;
    descend({kPatientStarts, kPatientIterations, steer, kPatientStarts});
    const int holding = solver_.repeats_joints() ? kCornerStarts : kHoldingStarts;
    if (found_.empty() && (outside_limits_ || stationary_ < kPatientStarts))  // at the limits?
      descend({holding, kPatientIterations, LaneLimits::Hold, holding});
  }
}

/// The branches of an exact structure are all there are, and so are the branches of a nearly exact
/// one if each of them led to a solution. Where limits leave none of an exact one, a singular pose
/// may have others than the representatives that were tried.
bool Search::knows_all(const ClosedForm& form) const {
  if (solver_.redundant())
    return false;
  if (form.exact())
    return !found_.empty() || !outside_limits_;
  return !found_.empty() && lost_ == 0;
}

void Search::append_branches(const ClosedForm& form) {
  if (form.has_lanes())
    return append_lanes(form);
  const auto locks = form.locks();
  const int attempts = locks.empty() ? 1 : std::max(kFewestLocks, 2 * static_cast<int>(wanted_));
  std::array<double, kLaneJoints> locked;
  std::size_t known = 0;
  for (int attempt = 0, idle = 0; attempt < attempts && idle < kIdleLocks && !enough(); ++attempt) {
    idle = found_.size() == known ? idle + 1 : 0;
    known = found_.size();
    CounterGenerator generator = generator_.of_attempt(next_start_++);
    for (std::size_t i = 0; i < locks.size(); ++i)
      locked[i] = solver_.space().value_at(locks[i], generator.uniform());
    append_at(form, {locked.data(), locks.size()});
  }
  form.exact() ? verify_or_polish() : polish();
}

void Search::append_at(const ClosedForm& form, std::span<const double> locked) {
  Branches branches;
  form.append(T_base_transfer_, locked, branches);
  outside_limits_ = outside_limits_ || branches.outside_limits();
  for (int i = 0; i < branches.size(); ++i)
    form.exact() ? propose_exact(branches[i]) : propose_near(branches[i]);
}

void Search::append_lanes(const ClosedForm& form) {
  const auto locks = form.locks();
  const int attempts = std::max(kLaneLockValues, 2 * static_cast<int>(wanted_));
  double locked[kLaneLocks][kLanes] = {};
  LaneWristBranches branches;
  std::array<double, kLaneJoints> q;
  for (int attempt = 0, idle = 0; attempt < attempts && idle < kIdleLocks && !enough();
       attempt += kLanes) {
    const std::size_t known = promised();
    for (int lane = 0; lane < kLanes; ++lane) {
      CounterGenerator generator = generator_.of_attempt(next_start_++);
      for (std::size_t i = 0; i < locks.size(); ++i)
        locked[i][lane] = solver_.space().value_at(locks[i], generator.uniform());
    }
    const int most = 2 * kLanes;
    form.append_lanes(solver_.kernels(), T_base_transfer_, locked, most, branches);
    outside_limits_ = outside_limits_ || branches.outside != 0;
    for (int i = 0; i < branches.count && !enough(); ++i) {
      form.write(branches, i, locked, q.data());
      form.exact() ? propose_exact(q.data()) : propose_near(q.data());
    }
    for (int lane = 0; lane < kLanes && !enough(); ++lane)
      if ((branches.hard >> static_cast<unsigned>(lane) & 1U) != 0)
        append_at(form, std::array{locked[0][lane], locked[1][lane]});
    if (promised() >= wanted_)
      form.exact() ? verify_or_polish() : polish();
    idle = promised() == known ? idle + kLanes : 0;
  }
  form.exact() ? verify_or_polish() : polish();
}

bool Search::append_eliminated(const LaneElimination& arm) {
  double target[12];
  for (int i = 0; i < 12; ++i)
    target[i] = batch_.target[i][0];
  LaneBranches branches;
  solver_.kernels().eliminate(solver_.lanes(), arm, harmonics(), target, branches);
  std::array<double, kLaneJoints> q;
  for (int b = 0; b < branches.count; ++b) {
    bool finite = true;
    for (int j = 0; j < solver_.lanes().dof; ++j) {
      q[static_cast<std::size_t>(j)] = branches.q[j][b] - solver_.lanes().joints[j].offset;
      finite = finite && std::isfinite(branches.q[j][b]);
    }
    if (finite)  // also beyond the limits: only a branch may count as one there
      propose(q.data());
    else
      ++lost_;
  }
  polish();
  return branches.count > 0 &&
         found_.size() + outside_.size() == static_cast<std::size_t>(branches.count);
}

void Search::propose_exact(const double* q) {
  std::array<double, kLaneJoints> candidate;
  std::copy_n(q, solver_.lanes().dof, candidate.data());
  hand_over(candidate);
  if (is_full())
    verify_or_polish();
}

void Search::propose_near(const double* q) {
  std::array<double, kLaneJoints> candidate;
  std::copy_n(q, solver_.lanes().dof, candidate.data());
  if (solver_.space().normalize(candidate.data(), ClosedForm::kNearMargin_rad))
    propose(candidate.data());
}

void Search::propose(const double* q) {
  put(q, proposed_);
  if (++proposed_ == kLanes)
    polish();
}

void Search::put(const double* q, int lane) {
  const LaneChain& chain = solver_.lanes();
  for (int j = 0; j < chain.dof; ++j)
    batch_.q[j][lane] = q[j] * chain.joints[j].scale + chain.joints[j].offset;
}

void Search::verify_or_polish() {
  if (handed_over_ == 0)
    return;
  solver_.kernels().check(solver_.arm(), check_);
  std::array<double, kLaneJoints> q;
  for (int lane = 0; lane < handed_over_ && !enough(); ++lane) {
    if (is_within(lane, kPolished)) {
      keep(lane);
      continue;
    }
    for (int j = 0; j < solver_.lanes().dof; ++j)
      q[static_cast<std::size_t>(j)] = check_.q[j][lane];
    put(q.data(), proposed_++);
  }
  handed_over_ = 0;
  polish();
}

void Search::polish() {
  if (proposed_ == 0)
    return;
  unsigned busy = (1U << static_cast<unsigned>(proposed_)) - 1;
  for (int i = 0; i < kPolishSteps && busy != 0; ++i) {
    solver_.kernels().step(solver_.lanes(), LaneLimits::Ignore, batch_);
    for (int lane = 0; lane < proposed_; ++lane) {
      const bool last = i + 1 == kPolishSteps && batch_.squared[lane] < kConverged;
      if ((busy >> static_cast<unsigned>(lane) & 1U) == 0 || !(converged(lane) || last))
        continue;
      hand_over(configuration(lane));
      busy &= ~(1U << static_cast<unsigned>(lane));
    }
  }
  lost_ += std::popcount(busy);
  proposed_ = 0;
  verify();
}

void Search::descend(const Effort& effort) {
  int waiting = effort.starts;  // not yet in a lane
  unsigned busy = 0;            // lanes, as bits
  idle_ = 0;
  for (int lane = 0; lane < kLanes && waiting > 0; ++lane, --waiting) {
    start(effort, lane);
    busy |= 1U << static_cast<unsigned>(lane);
  }
  while (busy != 0 && !enough() && !complete(effort)) {
    solver_.kernels().step(solver_.lanes(), effort.limits, batch_);
    for (int lane = 0; lane < kLanes; ++lane) {
      if ((busy >> static_cast<unsigned>(lane) & 1U) == 0)
        continue;
      const Ended ended = progress(effort, lane);
      if (ended == Ended::No)
        continue;
      ++idle_;
      if (ended == Ended::Converged) {
        hand_over(configuration(lane));
        if (is_full())
          verify();
      }
      if (waiting > 0) {
        --waiting;
        start(effort, lane);
      } else {
        busy &= ~(1U << static_cast<unsigned>(lane));
      }
    }
    if (!solver_.redundant() || busy == 0 || promised() >= wanted_)
      verify();
  }
  verify();
}

/// Six turning joints reach a pose in an even number of ways, +-2 pi copies aside, as the roots of
/// a polynomial of degree 16 come in pairs.
/// Source: Raghavan and Roth, Inverse kinematics of the general 6R manipulator and related
/// linkages, Journal of Mechanical Design 115 (1993).
bool Search::complete(const Effort& effort) const noexcept {
  if (!pairs_ || all_ || found_.empty())
    return idle_ >= effort.patience;
  const bool even = (found_.size() + outside_.size()) % 2 == 0;
  return idle_ >= (even ? kEvenPatience : kOddPatience);
}

void Search::start(const Effort& effort, int lane) {
  CounterGenerator generator = generator_.of_attempt(next_start_++);
  const LaneChain& chain = solver_.lanes();
  for (int j = 0; j < chain.dof; ++j) {
    const double share = generator.uniform();
    const double value = effort.anywhere ? solver_.space().value_anywhere(j, share)
                                         : solver_.space().value_at(j, share);
    batch_.q[j][lane] = value * chain.joints[j].scale + chain.joints[j].offset;
  }
  iterations_[static_cast<std::size_t>(lane)] = 0;
  near_[lane] = false;
}

/// At a singular pose, a straight arm say, a step only quarters the error: an arm of many metres
/// would be off by more than verification allows, whose limit does not grow with the arm.
bool Search::converged(int lane) const noexcept {
  const double squared = batch_.squared[lane];
  const double length_m = std::max(solver_.lanes().length_m, 1.0);
  return squared < kConverged &&
         (batch_.moved[lane] < kSettled || squared * length_m * length_m < kConverged);
}

Search::Ended Search::progress(const Effort& effort, int lane) {
  const double squared = batch_.squared[lane];
  if (converged(lane) && batch_.outside[lane] == 0) {
    least_squared_error_ = 0;
    return Ended::Converged;
  }
  int& iterations = iterations_[static_cast<std::size_t>(lane)];
  if (squared < kPromising[0] && !near_[lane]) {
    near_[lane] = true;
    if (is_known(lane))
      return Ended::Known;
  }
  const bool stationary = squared >= kConverged && batch_.moved[lane] < kStationary * squared;
  int most = effort.iterations;
  for (const double promising : kPromising)
    most += squared < promising ? kMoreIterations : 0;
  if (!stationary && ++iterations < most)
    return Ended::No;
  if (squared < kConverged && batch_.outside[lane] == 0) {
    least_squared_error_ = 0;
    return Ended::Converged;  // verification has the last word
  }
  stationary_ += stationary ? 1 : 0;
  least_squared_error_ = std::min(least_squared_error_, squared);
  return Ended::Failed;
}

std::array<double, kLaneJoints> Search::configuration(int lane) const {
  const LaneChain& chain = solver_.lanes();
  std::array<double, kLaneJoints> q;
  for (int j = 0; j < chain.dof; ++j)
    q[static_cast<std::size_t>(j)] =
        (batch_.q[j][lane] - chain.joints[j].offset) / chain.joints[j].scale;
  return q;
}

bool Search::is_known(int lane) const {
  if (solver_.redundant() || (found_.empty() && outside_.empty()))
    return false;
  std::array<double, kLaneJoints> q = configuration(lane);
  solver_.space().normalize(q.data());
  return !is_apart(solver_.space(), found_, q.data(), kKnown) ||
         !is_apart(solver_.space(), outside_, q.data(), kKnown);
}

void Search::leave_out(const double* q) {
  outside_limits_ = true;
  if (solver_.redundant() || !is_apart(solver_.space(), outside_, q, kSamePoint))
    return;
  outside_.add(q);
  idle_ = 0;
}

void Search::hand_over(std::array<double, kLaneJoints> q) {
  if (!solver_.space().normalize(q.data())) {
    leave_out(q.data());
    return;
  }
  if (!is_apart(solver_.space(), found_, q.data(), apart_))
    return;
  for (int j = 0; j < solver_.lanes().dof; ++j)
    check_.q[j][handed_over_] = q[static_cast<std::size_t>(j)];
  ++handed_over_;
}

bool Search::is_within(int lane, double tolerance) const noexcept {
  return check_.distance_m[lane] <= tolerance && check_.angle_rad[lane] <= tolerance;
}

void Search::keep(int lane) {
  std::array<double, kLaneJoints> q;
  for (int j = 0; j < solver_.lanes().dof; ++j)
    q[static_cast<std::size_t>(j)] = check_.q[j][lane];
  if (!is_apart(solver_.space(), found_, q.data(), apart_))
    return;
  found_.add(q.data());
  idle_ = 0;
}

void Search::verify() {
  if (handed_over_ == 0)
    return;
  solver_.kernels().check(solver_.arm(), check_);
  for (int lane = 0; lane < handed_over_ && !enough(); ++lane)
    if (is_within(lane, kPoseTolerance))
      keep(lane);
  handed_over_ = 0;
}

InverseSolutions Search::solutions() {
  InverseSolutions result;
  if (!found_.empty()) {
    if (!solver_.redundant())
      found_ = chosen(solver_.space(), std::move(found_), most_, min_distance_,
                      generator_.of_attempt(kChoice));
    result.configurations = found_.matrix();
    return result;
  }
  result.configurations.resize(solver_.space().dof(), 0);
  if (outside_limits_)
    result.reason = NoSolution::Limits;
  else if (least_squared_error_ > kFar * kFar || stationary_ >= kPatientStarts)
    result.reason = NoSolution::OutOfReach;
  else
    result.reason = NoSolution::NotConverged;
  return result;
}

}  // namespace kinship::inverse
