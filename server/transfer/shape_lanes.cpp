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
inverse::JointVector raw_of(const inverse::LaneChain& chain, const inverse::JointVector& q) {
  inverse::JointVector raw(chain.dof);
  for (int j = 0; j < chain.dof; ++j)
    raw[j] = q[j] * chain.joints[j].scale + chain.joints[j].offset;
  return raw;
}

inverse::JointVector joints_of(const inverse::LaneChain& chain, const inverse::JointVector& raw) {
  inverse::JointVector q(chain.dof);
  for (int j = 0; j < chain.dof; ++j)
    q[j] = (raw[j] - chain.joints[j].offset) / chain.joints[j].scale;
  return q;
}

/// Into, and out of, a kernel's columns.
template <typename Rows>
void write(const inverse::JointVector& raw, int seat, Rows& rows) {
  for (Eigen::Index j = 0; j < raw.size(); ++j)
    rows[j][seat] = raw[j];
}

template <typename Rows>
void read(const Rows& rows, int seat, inverse::JointVector& raw) {
  for (Eigen::Index j = 0; j < raw.size(); ++j)
    raw[j] = rows[j][seat];
}

/// \param unit_m  of lengths.
template <typename Rows>
void write_pose(const Eigen::Isometry3d& T, double unit_m, int seat, Rows& rows) {
  for (int i = 0; i < 9; ++i)
    rows[i][seat] = T(i / 3, i % 3);
  for (int i = 0; i < 3; ++i)
    rows[9 + i][seat] = T(i, 3) / unit_m;
}

}  // namespace

ShapeLanes::ShapeLanes(const ArmPair& pair) : pair_(pair), solver_(pair.target_solver()) {
  const Eigen::VectorXd middle = 0.5 * (pair.target().lower() + pair.target().upper());
  const inverse::JointVector raw = raw_of(solver_.lanes(), middle);
  seats_.fill(kEmpty);
  for (int lane = 0; lane < kCount; ++lane) {
    aim(lane, Eigen::Isometry3d::Identity(), ArmShape::Zero());
    put(lane, middle);
    work(lane).raw = raw;
  }
  for (int seat = 0; seat < kSeats; ++seat) {  // unwritten seats are computed with too
    write_pose(Eigen::Isometry3d::Identity(), 1, seat, batch_.target);
    write_pose(Eigen::Isometry3d::Identity(), 1, seat, check_.target);
    write(raw, seat, batch_.q);
    write(raw, seat, pull_.q);
    write(middle, seat, check_.q);
    for (auto& wanted : pull_.wanted)
      wanted[seat] = 0;
  }
}

void ShapeLanes::aim(int lane, const Eigen::Isometry3d& T_base_transfer, const ArmShape& wanted) {
  T_base_transfer_[static_cast<std::size_t>(lane)] = T_base_transfer;
  wanted_[static_cast<std::size_t>(lane)] = wanted;
}

void ShapeLanes::put(int lane, const inverse::JointVector& q) {
  q_[static_cast<std::size_t>(lane)] = q;
}

void ShapeLanes::begin_step(int lane, double most_motion, int steps) {
  Work& now = work(lane);
  now.most_motion = most_motion;
  now.start = at(lane);
  now.steps_left = steps;
  now.raw = raw_of(solver_.lanes(), at(lane));
  begin_descent(lane, State::Reaching);
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
  work_[i].raw = raw_of(solver_.lanes(), at(lane));
  begin_measuring(lane);
}

void ShapeLanes::begin_descent(int lane, State state) {
  work(lane).iterations = 0;
  to_descend_.push(lane);
  set(lane, state);
}

void ShapeLanes::begin_measuring(int lane) {
  to_measure_.push(lane);
  set(lane, State::Measuring);
}

bool ShapeLanes::run() {
  for (;;) {
    const int descending = count(State::Reaching) + count(State::Settling);
    const int measuring = count(State::Measuring);
    const int ended = count(State::Arrived) + count(State::Failed);
    if (measuring >= kSeats)
      measure();
    else if (descending >= kSeats)
      descend();
    else if (kEndedShare * ended >= descending + measuring)
      return ended > 0;
    else if (measuring >= kMeasuringShare * descending)
      measure();
    else
      descend();
  }
}

void ShapeLanes::seat() {
  for (int seat = 0; seat < kSeats && to_descend_.size() > 0; ++seat) {
    int& lane = seats_[static_cast<std::size_t>(seat)];
    if (lane != kEmpty)
      continue;
    lane = to_descend_.pop();
    write(work(lane).raw, seat, batch_.q);
    write_pose(T_base_transfer_[static_cast<std::size_t>(lane)], solver_.lanes().length_m, seat,
               batch_.target);
  }
}

/// Seats without a lane move for nothing.
void ShapeLanes::descend() {
  seat();
  solver_.kernels().step(solver_.lanes(), inverse::LaneLimits::Hold, batch_);
  for (int seat = 0; seat < kSeats; ++seat) {
    const int lane = seats_[static_cast<std::size_t>(seat)];
    if (lane == kEmpty)
      continue;
    const bool arrived = batch_.squared[seat] < kArrived;
    if (!arrived && ++work(lane).iterations <= kDescentIterations)
      continue;
    seats_[static_cast<std::size_t>(seat)] = kEmpty;
    read(batch_.q, seat, work(lane).raw);
    if (state(lane) == State::Reaching)
      arrived ? reached(lane) : set(lane, State::Failed);
    else
      arrived ? settled(lane) : end_pull(lane);
  }
}

void ShapeLanes::reached(int lane) {
  Work& now = work(lane);
  now.reached = joints_of(solver_.lanes(), now.raw);
  if (!((now.reached - now.start).norm() <= now.most_motion)) {
    set(lane, State::Failed);
    return;
  }
  put(lane, now.reached);
  start_pull(lane, now.steps_left);
}

void ShapeLanes::settled(int lane) {
  work(lane).settled = joints_of(solver_.lanes(), work(lane).raw);
  begin_measuring(lane);
}

void ShapeLanes::measure() {
  std::array<int, kSeats> lanes{};
  const int taken = std::min(to_measure_.size(), kSeats);
  for (int seat = 0; seat < taken; ++seat) {
    const int lane = lanes[static_cast<std::size_t>(seat)] = to_measure_.pop();
    write(work(lane).raw, seat, pull_.q);
    for (int i = 0; i < ArmShapeMotion::kRows; ++i)
      pull_.wanted[i][seat] = wanted_[static_cast<std::size_t>(lane)].reshaped()[i];
  }
  solver_.kernels().pull(solver_.lanes(), *pair_.target_marks(), pull_);
  for (int seat = 0; seat < taken; ++seat)
    measured(lanes[static_cast<std::size_t>(seat)], seat);
}

void ShapeLanes::measured(int lane, int seat) {
  Work& now = work(lane);
  const double reached_m = pull_.distance_m[seat];
  const bool gains = reached_m <= now.distance_m * (1 - kMinGain);
  if (reached_m < now.distance_m) {
    put(lane, now.settled);
    now.distance_m = reached_m;
  }
  if (!gains || now.steps_left == 0) {
    end_pull(lane);
    return;
  }
  --now.steps_left;
  read(pull_.q, seat, now.raw);
  begin_descent(lane, State::Settling);
}

void ShapeLanes::end_pull(int lane) {
  if (!((at(lane) - work(lane).start).norm() <= work(lane).most_motion))
    put(lane, work(lane).reached);
  set(lane, State::Arrived);
}

std::array<bool, ShapeLanes::kCount> ShapeLanes::verified(const Eigen::MatrixXd& configurations) {
  std::array<bool, kCount> right{};
  std::array<int, kSeats> lanes{};
  int taken = 0;
  const auto check = [&] {
    solver_.kernels().check(solver_.arm(), check_);
    for (int seat = 0; seat < taken; ++seat)
      right[static_cast<std::size_t>(lanes[static_cast<std::size_t>(seat)])] =
          check_.distance_m[seat] <= inverse::kPoseTolerance &&
          check_.angle_rad[seat] <= inverse::kPoseTolerance;
    taken = 0;
  };
  for (int lane = 0; lane < kCount; ++lane) {
    if (state(lane) != State::Arrived && !is_idle(lane))
      continue;
    for (int j = 0; j < solver_.lanes().dof; ++j)
      check_.q[j][taken] = configurations(j, lane);
    write_pose(T_base_transfer_[static_cast<std::size_t>(lane)], 1, taken, check_.target);
    lanes[static_cast<std::size_t>(taken)] = lane;
    if (++taken == kSeats)
      check();
  }
  if (taken > 0)
    check();
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
      write(raw_of(solver.lanes(),
                   configurations.col(first + std::min<Eigen::Index>(lane, many - 1))),
            lane, measured.q);
    solver.kernels().pull(solver.lanes(), *pair.target_marks(), measured);
    std::copy_n(measured.distance_m, many, distances.data() + first);
  }
  return distances;
}

}  // namespace kinship::transfer
