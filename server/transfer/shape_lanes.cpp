#include "server/transfer/shape_lanes.hpp"

#include <algorithm>

#include "server/transfer/shape_pull.hpp"

namespace kinship::transfer {
namespace {

constexpr double kLeastGain = 1e-3;  // share of the distance that a step has to take away
constexpr int kDescentIterations = 15;
constexpr double kArrived = 1e-8;  // squared error before a last step, which squares it again

bool has(unsigned lanes, int lane) { return (lanes >> static_cast<unsigned>(lane) & 1U) != 0; }
unsigned bit(int lane) { return 1U << static_cast<unsigned>(lane); }

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

}  // namespace

ShapeLanes::ShapeLanes(const ArmPair& pair) : pair_(pair), solver_(pair.target_solver()) {
  const Eigen::VectorXd middle = 0.5 * (pair.target().lower() + pair.target().upper());
  for (int lane = 0; lane < kCount; ++lane) {
    aim(lane, Eigen::Isometry3d::Identity(), ArmShape::Zero());
    put(lane, middle);
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

inverse::JointVector ShapeLanes::at(int lane) const { return q_[static_cast<std::size_t>(lane)]; }

unsigned ShapeLanes::reach(unsigned lanes) {
  for (int lane = 0; lane < kCount; ++lane)
    write(solver_.lanes(), at(lane), lane, batch_.q);
  const unsigned arrived = descend(lanes);
  for (int lane = 0; lane < kCount; ++lane)
    if (has(arrived, lane))
      put(lane, read(solver_.lanes(), batch_.q, lane));
  return arrived;
}

/// Of what stands in the batch; all lanes move, those that have arrived next to nothing.
unsigned ShapeLanes::descend(unsigned lanes) {
  unsigned arrived = 0;
  for (int i = 0; i <= kDescentIterations && arrived != lanes; ++i) {
    solver_.kernels().step(solver_.lanes(), inverse::LaneLimits::Hold, batch_);
    for (int lane = 0; lane < kCount; ++lane)
      if (has(lanes, lane) && batch_.squared[lane] < kArrived)
        arrived |= bit(lane);
  }
  return arrived;
}

void ShapeLanes::pull(unsigned lanes, int steps) {
  const inverse::LaneChain& chain = solver_.lanes();
  if (!pair_.target_marks()) {
    for (int lane = 0; lane < kCount; ++lane)
      if (has(lanes, lane))
        pull_one(lane, steps);
    return;
  }
  for (int lane = 0; lane < kCount; ++lane)
    write(chain, at(lane), lane, pull_.q);
  solver_.kernels().pull(chain, *pair_.target_marks(), pull_);
  std::copy_n(pull_.distance_m, kCount, distance_m_.begin());
  if (!solver_.redundant())  // no self-motion
    return;
  for (int i = 0; i < steps && lanes != 0; ++i) {
    std::copy_n(&pull_.q[0][0], chain.dof * kCount, &batch_.q[0][0]);
    lanes = descend(lanes);
    std::copy_n(&batch_.q[0][0], chain.dof * kCount, &pull_.q[0][0]);
    solver_.kernels().pull(chain, *pair_.target_marks(), pull_);
    for (int lane = 0; lane < kCount; ++lane) {
      double& distance_m = distance_m_[static_cast<std::size_t>(lane)];
      const double reached_m = pull_.distance_m[lane];
      if (!has(lanes, lane))
        continue;
      if (!(reached_m <= distance_m * (1 - kLeastGain)))
        lanes &= ~bit(lane);
      if (!(reached_m < distance_m))
        continue;
      put(lane, read(chain, batch_.q, lane));
      distance_m = reached_m;
    }
  }
}

Eigen::VectorXd ShapeLanes::distances_m(const Eigen::MatrixXd& configurations,
                                        const ArmShape& wanted) const {
  const Eigen::Index count = configurations.cols();
  Eigen::VectorXd distances(count);
  if (!pair_.target_marks()) {
    for (Eigen::Index i = 0; i < count; ++i)
      distances[i] = shape_distance(arm_shape(pair_.target(), configurations.col(i)), wanted);
    return distances;
  }
  inverse::LanePull measured = pull_;
  for (int i = 0; i < ArmShapeMotion::kRows; ++i)
    std::fill_n(measured.wanted[i], kCount, wanted.reshaped()[i]);
  for (Eigen::Index first = 0; first < count; first += kCount) {
    const Eigen::Index many = std::min<Eigen::Index>(kCount, count - first);
    for (int lane = 0; lane < kCount; ++lane)
      write(solver_.lanes(), configurations.col(first + std::min<Eigen::Index>(lane, many - 1)),
            lane, measured.q);
    solver_.kernels().pull(solver_.lanes(), *pair_.target_marks(), measured);
    std::copy_n(measured.distance_m, many, distances.data() + first);
  }
  return distances;
}

void ShapeLanes::pull_one(int lane, int steps) {
  const auto i = static_cast<std::size_t>(lane);
  distance_m_[i] = pull_alone(pair_, T_base_transfer_[i], wanted_[i], steps, q_[i]);
}

unsigned ShapeLanes::verified(unsigned lanes, const Eigen::MatrixXd& configurations) {
  for (int lane = 0; lane < kCount; ++lane)
    for (int j = 0; j < solver_.lanes().dof; ++j)
      check_.q[j][lane] = configurations(j, lane);
  solver_.kernels().check(solver_.arm(), check_);
  unsigned right = 0;
  for (int lane = 0; lane < kCount; ++lane)
    if (has(lanes, lane) && check_.distance_m[lane] <= inverse::kPoseTolerance &&
        check_.angle_rad[lane] <= inverse::kPoseTolerance)
      right |= bit(lane);
  return right;
}

}  // namespace kinship::transfer
