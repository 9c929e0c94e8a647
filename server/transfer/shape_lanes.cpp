#include "server/transfer/shape_lanes.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "server/transfer/shape_pull.hpp"

namespace kinship::transfer {
namespace {

constexpr double kLeastGain = 1e-3;  // share of the distance that a step has to take away
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
  reaching_ |= lane_bit(lane);
}

void ShapeLanes::begin_pull(int lane, int steps) {
  Work& now = work(lane);
  now.most_motion = std::numeric_limits<double>::infinity();
  now.start = now.reached = at(lane);
  start_pull(lane, steps);
}

void ShapeLanes::start_pull(int lane, int steps) {
  const auto i = static_cast<std::size_t>(lane);
  work_[i].steps_left = steps;
  work_[i].distance_m = std::numeric_limits<double>::infinity();  // not measured yet
  if (!pair_.target_marks()) {
    work_[i].distance_m = pull_alone(pair_, T_base_transfer_[i], wanted_[i], steps, q_[i]);
    pulled_ |= lane_bit(lane);
  } else if (!solver_.redundant()) {  // no self-motion
    pulled_ |= lane_bit(lane);
  } else {
    work_[i].settled = at(lane);
    write(solver_.lanes(), at(lane), lane, pull_.q);
    measuring_ |= lane_bit(lane);
  }
}

ShapeLanes::Ended ShapeLanes::run() {
  Ended ended;
  for (;;) {
    end_pulls(ended);
    const int descending = std::popcount(reaching_ | settling_);
    const int measuring = std::popcount(measuring_);
    if (kEndedShare * std::popcount(ended.arrived | ended.failed) >= descending + measuring)
      return ended;
    if (measuring >= kMeasuringShare * descending)
      measure();
    else
      descend(ended);
  }
}

/// All lanes of the batch move, those that do not descend for nothing.
void ShapeLanes::descend(Ended& ended) {
  solver_.kernels().step(solver_.lanes(), inverse::LaneLimits::Hold, batch_);
  const unsigned reaching = reaching_;
  const unsigned descending = reaching_ | settling_;
  for (int lane = 0; lane < kCount; ++lane) {
    if (!has_lane(descending, lane))
      continue;
    const bool arrived = batch_.squared[lane] < kArrived;
    if (!arrived && ++work(lane).iterations <= kDescentIterations)
      continue;
    reaching_ &= ~lane_bit(lane);
    settling_ &= ~lane_bit(lane);
    if (!arrived)
      (has_lane(reaching, lane) ? ended.failed : pulled_) |= lane_bit(lane);
    else if (has_lane(reaching, lane))
      reached(lane, ended);
    else
      settled(lane);
  }
}

void ShapeLanes::reached(int lane, Ended& ended) {
  Work& now = work(lane);
  now.reached = read(solver_.lanes(), batch_.q, lane);
  if (!((now.reached - now.start).norm() <= now.most_motion)) {
    ended.failed |= lane_bit(lane);
    return;
  }
  put(lane, now.reached);
  start_pull(lane, now.steps_left);
}

void ShapeLanes::settled(int lane) {
  work(lane).settled = read(solver_.lanes(), batch_.q, lane);
  copy_lane(solver_.lanes(), lane, batch_.q, pull_.q);
  measuring_ |= lane_bit(lane);
}

void ShapeLanes::measure() {
  solver_.kernels().pull(solver_.lanes(), *pair_.target_marks(), pull_);
  for (int lane = 0; lane < kCount; ++lane) {
    if (!has_lane(measuring_, lane))
      continue;
    Work& now = work(lane);
    const double reached_m = pull_.distance_m[lane];
    const bool gains = reached_m <= now.distance_m * (1 - kLeastGain);
    if (reached_m < now.distance_m) {
      put(lane, now.settled);
      now.distance_m = reached_m;
    }
    if (!gains || now.steps_left == 0) {
      pulled_ |= lane_bit(lane);
      continue;
    }
    --now.steps_left;
    now.iterations = 0;
    copy_lane(solver_.lanes(), lane, pull_.q, batch_.q);
    settling_ |= lane_bit(lane);
  }
  measuring_ = 0;
}

void ShapeLanes::end_pulls(Ended& ended) {
  for (int lane = 0; lane < kCount; ++lane)
    if (has_lane(pulled_, lane) &&
        !((at(lane) - work(lane).start).norm() <= work(lane).most_motion))
      put(lane, work(lane).reached);
  ended.arrived |= pulled_;
  pulled_ = 0;
}

void ShapeLanes::pull(unsigned lanes, int steps) {
  for (int lane = 0; lane < kCount; ++lane)
    if (has_lane(lanes, lane))
      begin_pull(lane, steps);
  while ((reaching_ | settling_ | measuring_ | pulled_) != 0)
    run();
}

unsigned ShapeLanes::verified(unsigned lanes, const Eigen::MatrixXd& configurations) {
  for (int lane = 0; lane < kCount; ++lane)
    for (int j = 0; j < solver_.lanes().dof; ++j)
      check_.q[j][lane] = configurations(j, lane);
  solver_.kernels().check(solver_.arm(), check_);
  unsigned right = 0;
  for (int lane = 0; lane < kCount; ++lane)
    if (has_lane(lanes, lane) && check_.distance_m[lane] <= inverse::kPoseTolerance &&
        check_.angle_rad[lane] <= inverse::kPoseTolerance)
      right |= lane_bit(lane);
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
