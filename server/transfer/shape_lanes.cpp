#include "server/transfer/shape_lanes.hpp"

#include <algorithm>
#include <limits>

#include "server/transfer/shape_pull.hpp"

namespace kinship::transfer {
namespace {

constexpr double kMinGain = 1e-3;  // share of the distance that a step has to take away
constexpr int kDescentIterations = 15;
constexpr double kArrived = 1e-12;  // squared error before a last step, which squares it again
constexpr int kEndedShare = 3;      // of the lanes at work, one in so many
constexpr int kMeasuringShare = 2;  // so many for each that descends: a pull costs three descents

/// Values of the joints as the kernels have them.
template <typename Rows>
void write(const inverse::LaneChain& chain, const inverse::JointVector& q, int lane, Rows& rows) {
  for (int j = 0; j < chain.dof; ++j)
    rows[j][lane] = q[j] * chain.joints[j].scale + chain.joints[j].offset;
}

template <typename Rows>
inverse::JointVector read(const inverse::LaneChain& chain, const Rows& rows, int lane) {
  inverse::JointVector q(chain.dof);
  for (int j = 0; j < chain.dof; ++j)
    q[j] = (rows[j][lane] - chain.joints[j].offset) / chain.joints[j].scale;
  return q;
}

template <typename Rows>
void copy_lane(const inverse::LaneChain& chain, int lane, const Rows& from, Rows& to) {
  for (int j = 0; j < chain.dof; ++j)
    to[j][lane] = from[j][lane];
}

}  // namespace

ShapeLanes::ShapeLanes(const ArmPair& pair) : pair_(pair), solver_(pair.target_solver()) {
  const Eigen::VectorXd middle = 0.5 * (pair.target().lower() + pair.target().upper());
  for (int lane = 0; lane < kCount; ++lane) {
    aim(lane, Eigen::Isometry3d::Identity(), ArmShape::Zero());
    put(lane, middle);
    write(solver_.lanes(), middle, lane, batch_.q);
    write(solver_.lanes(), middle, lane, pull_.q);
  }
}

void ShapeLanes::aim(int lane, const Eigen::Isometry3d& T_base_transfer, const ArmShape& wanted) {
  T_base_transfer_[static_cast<std::size_t>(lane)] = T_base_transfer;
  wanted_[static_cast<std::size_t>(lane)] = wanted;
  for (int i = 0; i < 12; ++i) {
    const double value = i < 9 ? T_base_transfer(i / 3, i % 3) : T_base_transfer(i - 9, 3);
    check_.target[i][lane] = value;
    batch_.target[i][lane] = i < 9 ? value : value / solver_.lanes().length_m;
  }
  for (int i = 0; i < ArmShapeMotion::kRows; ++i)
    pull_.wanted[i][lane] = wanted.reshaped()[i];
}

void ShapeLanes::put(int lane, const inverse::JointVector& q) {
  q_[static_cast<std::size_t>(lane)] = q;
}

void ShapeLanes::begin_step(int lane, double most_motion, int steps) {
  Work& now = work(lane);
  now.most_motion = most_motion;
  now.start = at(lane);
  now.iterations = 0;
  now.steps_left = steps;
  write(solver_.lanes(), at(lane), lane, batch_.q);
  set(lane, State::Reaching);
}

void ShapeLanes::begin_pull(int lane, int steps) {
  Work& now = work(lane);
  now.most_motion = std::numeric_limits<double>::infinity();
  now.start = now.reached = at(lane);
  start_pull(lane, steps);
}

void ShapeLanes::start_pull(int lane, int steps) {
  const auto i = static_cast<std::size_t>(lane);
  if (!pair_.target_marks()) {
    pull_alone(pair_, T_base_transfer_[i], wanted_[i], steps, q_[i]);
    return end_pull(lane);
  }
  if (!solver_.redundant())  // no self-motion
    return end_pull(lane);
  work_[i].steps_left = steps;
  work_[i].distance_m = std::numeric_limits<double>::infinity();  // not measured yet
  work_[i].settled = at(lane);
  write(solver_.lanes(), at(lane), lane, pull_.q);
  set(lane, State::Measuring);
}

bool ShapeLanes::run() {
  for (;;) {
    const int descending = count(State::Reaching) + count(State::Settling);
    const int measuring = count(State::Measuring);
    const int ended = count(State::Arrived) + count(State::Failed);
    if (kEndedShare * ended >= descending + measuring)
      return ended > 0;
    if (measuring >= kMeasuringShare * descending)
      measure();
    else
      descend();
  }
}

/// All lanes of the batch move, those that do not descend for nothing.
void ShapeLanes::descend() {
  solver_.kernels().step(solver_.lanes(), inverse::LaneLimits::Hold, batch_);
  for (int lane = 0; lane < kCount; ++lane) {
    const bool reaching = state(lane) == State::Reaching;
    if (!reaching && state(lane) != State::Settling)
      continue;
    const bool arrived = batch_.squared[lane] < kArrived;
    if (!arrived && ++work(lane).iterations <= kDescentIterations)
      continue;
    if (reaching)
      arrived ? reached(lane) : set(lane, State::Failed);
    else
      arrived ? settled(lane) : end_pull(lane);
  }
}

void ShapeLanes::reached(int lane) {
  Work& now = work(lane);
  now.reached = read(solver_.lanes(), batch_.q, lane);
  if (!((now.reached - now.start).norm() <= now.most_motion)) {
    set(lane, State::Failed);
    return;
  }
  put(lane, now.reached);
  start_pull(lane, now.steps_left);
}

void ShapeLanes::settled(int lane) {
  work(lane).settled = read(solver_.lanes(), batch_.q, lane);
  copy_lane(solver_.lanes(), lane, batch_.q, pull_.q);
  set(lane, State::Measuring);
}

void ShapeLanes::measure() {
  solver_.kernels().pull(solver_.lanes(), *pair_.target_marks(), pull_);
  for (int lane = 0; lane < kCount; ++lane) {
    if (state(lane) != State::Measuring)
      continue;
    Work& now = work(lane);
    const double reached_m = pull_.distance_m[lane];
    const bool gains = reached_m <= now.distance_m * (1 - kMinGain);
    if (reached_m < now.distance_m) {
      put(lane, now.settled);
      now.distance_m = reached_m;
    }
    if (!gains || now.steps_left == 0) {
      end_pull(lane);
      continue;
    }
    --now.steps_left;
    now.iterations = 0;
    copy_lane(solver_.lanes(), lane, pull_.q, batch_.q);
    set(lane, State::Settling);
  }
}

void ShapeLanes::end_pull(int lane) {
  if (!((at(lane) - work(lane).start).norm() <= work(lane).most_motion))
    put(lane, work(lane).reached);
  set(lane, State::Arrived);
}

std::array<bool, ShapeLanes::kCount> ShapeLanes::verified(const Eigen::MatrixXd& configurations) {
  for (int lane = 0; lane < kCount; ++lane)
    for (int j = 0; j < solver_.lanes().dof; ++j)
      check_.q[j][lane] = configurations(j, lane);
  solver_.kernels().check(solver_.arm(), check_);
  std::array<bool, kCount> right{};
  for (int lane = 0; lane < kCount; ++lane)
    right[static_cast<std::size_t>(lane)] = check_.distance_m[lane] <= inverse::kPoseTolerance &&
                                            check_.angle_rad[lane] <= inverse::kPoseTolerance;
  return right;
}

Eigen::VectorXd shape_distances_m(const ArmPair& pair, const Eigen::MatrixXd& configurations,
                                  const ArmShape& wanted) {
  constexpr int kCount = inverse::kLanes;
  const inverse::Solver& solver = pair.target_solver();
  const Eigen::Index count = configurations.cols();
  Eigen::VectorXd distances(count);
  if (!pair.target_marks()) {
    for (Eigen::Index i = 0; i < count; ++i)
      distances[i] = shape_distance(arm_shape(pair.target(), configurations.col(i)), wanted);
    return distances;
  }
  inverse::LanePull measured;
  for (int i = 0; i < ArmShapeMotion::kRows; ++i)
    std::fill_n(measured.wanted[i], kCount, wanted.reshaped()[i]);
  for (Eigen::Index first = 0; first < count; first += kCount) {
    const Eigen::Index many = std::min<Eigen::Index>(kCount, count - first);
    for (int lane = 0; lane < kCount; ++lane)
      write(solver.lanes(), configurations.col(first + std::min<Eigen::Index>(lane, many - 1)),
            lane, measured.q);
    solver.kernels().pull(solver.lanes(), *pair.target_marks(), measured);
    std::copy_n(measured.distance_m, many, distances.data() + first);
  }
  return distances;
}

}  // namespace kinship::transfer
