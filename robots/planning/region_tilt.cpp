#include "robots/planning/region_tilt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/types/turn.hpp"
#include "robots/kinematics/joint_motion.hpp"

namespace kinship::planning {
namespace {

/// Modulo a full turn, in [-pi, pi]; wrapped() is a slow call.
double within_half_a_turn(double angle) {
  return std::abs(angle) <= M_PI ? angle : angle - kTurn * std::floor(angle / kTurn + 0.5);
}

double angle_beyond(double angle, double lower, double upper) {
  if (std::isinf(lower))
    return 0;
  const double middle = (lower + upper) / 2;
  const double value = middle + within_half_a_turn(angle - middle);
  return value > upper ? value - upper : std::min(value - lower, 0.0);
}

Eigen::Vector3d angles_beyond(const Eigen::Vector3d& angles,
                              const Eigen::Ref<const Eigen::Matrix<double, 2, 3>>& bounds) {
  Eigen::Vector3d excess;
  for (Eigen::Index i = 0; i < 3; ++i)
    excess[i] = angle_beyond(angles[i], bounds(0, i), bounds(1, i));
  return excess;
}

}  // namespace

AngleExcess angle_excess(const Eigen::Vector3d& angles,
                         const Eigen::Ref<const Eigen::Matrix<double, 2, 3>>& bounds) {
  const Eigen::Vector3d one = angles_beyond(angles, bounds);
  if (one.squaredNorm() == 0)
    return {one, false};
  const Eigen::Vector3d other =
      angles_beyond({angles[0] + M_PI, M_PI - angles[1], angles[2] + M_PI}, bounds);
  if (other.squaredNorm() < one.squaredNorm())
    return {other, true};
  return {one, false};
}

RegionTilt::RegionTilt(const std::vector<Joint>& joints, const Eigen::Matrix3d& R_end,
                       const Eigen::Matrix2d& bounds, const Eigen::Array2d& margin)
    : dof_(static_cast<Eigen::Index>(joints.size())),
      first_(joints.front().R.row(2)),
      R_end_(R_end),
      margin_(margin),
      roll_(cone_of(bounds(0, 0), bounds(1, 0))),
      pitch_(cone_of(bounds(0, 1), bounds(1, 1))) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  bounds_ << bounds, Eigen::Vector2d(-kInfinity, kInfinity);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    turns_[i] = joints[i].slides ? 0 : 1;
    tilt_sine_[i] = 0;
    tilt_cosine_[i] = 1;
    if (i == 0)
      continue;
    const kinematics::AxisTurns turns = kinematics::axis_turns(joints[i].R);
    offset_[i - 1] += turns.before;
    tilt_sine_[i - 1] = turns.tilt_sine;
    tilt_cosine_[i - 1] = turns.tilt_cosine;
    offset_[i] += turns.after;
  }
}

RegionTilt::Cone RegionTilt::cone_of(double lower, double upper) {
  const double half = (upper - lower) / 2, middle = (lower + upper) / 2;
  if (!(half < M_PI / 2))
    return {0, 1, std::numeric_limits<double>::quiet_NaN()};  // nothing is below that
  return {std::sin(middle), std::cos(middle), std::tan(half)};
}

void RegionTilt::sweep(const Eigen::VectorXd& q, Sweep& along) const {
  alignas(16) double angles[kRoom];
  angles[dof_ - 1 + dof_ % 2] = 0;
  for (Eigen::Index i = 0; i < dof_; ++i)
    angles[i] = offset_[i] + turns_[i] * q[i];
  turn_joints(angles, dof_, along.turns);
  double a = first_[0], b = first_[1], c = first_[2];
  for (Eigen::Index i = 0; i < dof_; ++i) {
    const double sine = along.turns.sine[i], cosine = along.turns.cosine[i];
    const double x = cosine * a + sine * b, y = cosine * b - sine * a;
    along.x[i] = a = x;
    along.y[i] = y;
    b = tilt_cosine_[i] * y + tilt_sine_[i] * c;
    c = tilt_cosine_[i] * c - tilt_sine_[i] * y;
  }
  along.end.noalias() = Eigen::RowVector3d(a, b, c) * R_end_;
}

RegionTilt::Excess RegionTilt::excess(const Eigen::RowVector3d& end) const {
  const double level = std::sqrt(end[1] * end[1] + end[2] * end[2]);
  const auto lies_in = [](const Cone& cone, double sine, double cosine) {
    return std::abs(sine * cone.cosine - cosine * cone.sine) <
           cone.slope * (cosine * cone.cosine + sine * cone.sine);
  };
  if (lies_in(roll_, end[1], end[2]) && lies_in(pitch_, -end[0], level))
    return {Eigen::Array2d::Zero(), false};
  const AngleExcess found =
      angle_excess({std::atan2(end[1], end[2]), std::atan2(-end[0], level), 0}, bounds_);
  return {found.beyond.head<2>().array(), found.is_flipped};
}

Eigen::Array2d RegionTilt::excess(const Eigen::VectorXd& q) const {
  Sweep along;
  sweep(q, along);
  return excess(along.end).beyond;
}

void RegionTilt::improve(const Sweep& along, const Excess& outside, Eigen::VectorXd& q) const {
  // Of the angles that are outside, per change of the row, as columns: two of each coordinate.
  const Eigen::RowVector3d& end = along.end;
  const Eigen::Array2d is_outside = (outside.beyond != 0).cast<double>();
  const double squared = std::max(end[1] * end[1] + end[2] * end[2], kMinCosine * kMinCosine);
  const double pitch_rate = (outside.is_flipped ? 1 : -1) / std::sqrt(squared);
  const Eigen::Array2d rates[3] = {is_outside * Eigen::Array2d(0, pitch_rate),
                                   is_outside * Eigen::Array2d(end[2] / squared, 0),
                                   is_outside * Eigen::Array2d(-end[1] / squared, 0)};
  Eigen::Array2d a, b, c;
  a = R_end_(0, 0) * rates[0] + R_end_(0, 1) * rates[1] + R_end_(0, 2) * rates[2];
  b = R_end_(1, 0) * rates[0] + R_end_(1, 1) * rates[1] + R_end_(1, 2) * rates[2];
  c = R_end_(2, 0) * rates[0] + R_end_(2, 1) * rates[1] + R_end_(2, 2) * rates[2];
  Eigen::Array2d J[kRoom];
  Eigen::Array2d squares = Eigen::Array2d::Zero();
  double product = 0;
  for (Eigen::Index i = dof_ - 1; i >= 0; --i) {
    const double sine = along.turns.sine[i], cosine = along.turns.cosine[i];
    const Eigen::Array2d y = tilt_cosine_[i] * b - tilt_sine_[i] * c;
    c = tilt_sine_[i] * b + tilt_cosine_[i] * c;
    J[i] = turns_[i] * (along.y[i] * a - along.x[i] * y);
    squares += J[i].square();
    product += J[i][0] * J[i][1];
    b = sine * a + cosine * y;
    a = cosine * a - sine * y;
  }
  // (J J^T + damping)^-1 times the excess to be taken back: two rows, or one and an empty one.
  const Eigen::Array2d wanted =
      is_outside * (outside.beyond + (outside.beyond > 0).select(margin_, -margin_));
  squares += kSquaredDamping;
  const Eigen::Array2d others(squares[1], squares[0]), crossed(wanted[1], wanted[0]);
  const Eigen::Array2d taken =
      (others * wanted - product * crossed) / (squares[0] * squares[1] - product * product);
  for (Eigen::Index i = 0; i < dof_; ++i)
    q[i] -= taken[0] * J[i][0] + taken[1] * J[i][1];
}

bool RegionTilt::project(const Eigen::Matrix2Xd& bounds, Eigen::VectorXd& q) const {
  Sweep along;
  for (int iteration = 0;; ++iteration) {
    sweep(q, along);
    const Excess outside = excess(along.end);
    if (outside.beyond.matrix().squaredNorm() <= kAimed * kAimed)
      return true;
    if (iteration == kMaxIterations)
      return false;
    improve(along, outside, q);
    q = q.cwiseMax(bounds.row(0).transpose()).cwiseMin(bounds.row(1).transpose());
  }
}

}  // namespace kinship::planning
