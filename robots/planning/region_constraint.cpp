#include "robots/planning/region_constraint.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "proto/types/turn.hpp"
#include "robots/kinematics/joint_motion.hpp"
#include "robots/planning/region_tilt.hpp"

namespace kinship::planning {
namespace {

using Vector6 = RegionConstraint::Vector6;

constexpr double kMarginOfWidth = 0.05, kMaxMargin = 0.02;  // m or rad

/// Angles without a bound on one side are bounded by half a turn there; angles that may go round by
/// nothing.
Eigen::Matrix<double, 2, 6> with_angles_in_a_turn(Eigen::Matrix<double, 2, 6> bounds) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 3; i < 6; ++i) {
    if (std::isfinite(bounds(0, i)) != std::isfinite(bounds(1, i)))
      bounds.col(i) << std::max(bounds(0, i), -M_PI), std::min(bounds(1, i), M_PI);
    if (bounds(1, i) - bounds(0, i) >= kTurn)
      bounds.col(i) << -kInfinity, kInfinity;
  }
  return bounds;
}

double beyond(double value, double lower, double upper) {
  return value > upper ? value - upper : std::min(value - lower, 0.0);
}

constexpr double kRounding = 1e-9;  // joint units
/// Of a stride: a projection that takes back more has met the end of the way along the region.
constexpr double kMinProgress = 0.2;
constexpr int kHalvings = 2;

}  // namespace

TaskSpaceRegion upright_region(double tilt_rad) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  TaskSpaceRegion region;
  region.T_region_end.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  region.bounds.row(0) << -kInfinity, -kInfinity, -kInfinity, -tilt_rad, -tilt_rad, -kInfinity;
  region.bounds.row(1) = -region.bounds.row(0);
  return region;
}

RegionConstraint::RegionConstraint(const kinematics::Chain& chain, const TaskSpaceRegion& region,
                                   const Eigen::Isometry3d& T_task_base,
                                   const Eigen::Matrix2Xd& bounds)
    : region_bounds_(with_angles_in_a_turn(region.bounds)), bounds_(bounds) {
  if (const auto fault = validate(region))
    throw std::invalid_argument("RegionConstraint: " + *fault);
  if (bounds.cols() != chain.dof())
    throw std::invalid_argument("RegionConstraint: bounds and chain differ in size");
  const Vector6 widths = (region_bounds_.row(1) - region_bounds_.row(0)).transpose();
  margin_ = (kMarginOfWidth * widths).cwiseMin(kMaxMargin);
  Eigen::Isometry3d T = region.T_task_region.inverse() * T_task_base;  // before the next joint
  for (const kinematics::Joint& joint : chain.joints()) {
    const Eigen::Isometry3d T_joint_z(kinematics::rotation_of_z_to(joint.axis));
    T = T * joint.T_previous_joint * T_joint_z;
    segments_.push_back(
        {T.linear(), T.translation(), joint.type == kinematics::JointType::Prismatic});
    T = T_joint_z.inverse();
  }
  T = T * chain.T_last_tip() * chain.T_tip_transfer() * region.T_region_end.inverse();
  R_end_ = T.linear();
  p_end_ = T.translation();
  tilt_ = tilt();
}

std::shared_ptr<const RegionTilt> RegionConstraint::tilt() const {
  for (const Eigen::Index other : {0, 1, 2, 5})
    if (!std::isinf(region_bounds_(0, other)) || !std::isinf(region_bounds_(1, other)))
      return nullptr;
  std::vector<RegionTilt::Joint> joints;
  for (const Segment& segment : segments_)
    joints.push_back({segment.R, segment.prismatic});
  return std::make_shared<const RegionTilt>(joints, R_end_, region_bounds_.middleCols<2>(3),
                                            margin_.segment<2>(3).array());
}

void RegionConstraint::sweep(const Eigen::VectorXd& q, Sweep& along) const {
  const auto count = static_cast<Eigen::Index>(segments_.size());
  along.origins.resize(3, count);
  along.axes.resize(3, count);
  alignas(16) double angles[kMaxDof];
  angles[count - 1 + count % 2] = 0;
  std::copy_n(q.data(), count, angles);
  JointTurns turns;
  turn_joints(angles, count, turns);
  Eigen::Matrix3d R = segments_.front().R;
  Eigen::Vector3d p = segments_.front().p;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Segment& segment = segments_[static_cast<std::size_t>(i)];
    if (i > 0) {
      p += R * segment.p;
      R = (R * segment.R).eval();
    }
    along.origins.col(i) = p;
    along.axes.col(i) = R.col(2);
    if (segment.prismatic) {
      p += q[i] * R.col(2);
      continue;
    }
    const double c = turns.cosine[i], s = turns.sine[i];
    const Eigen::Vector3d x = R.col(0);
    R.col(0) = c * x + s * R.col(1);
    R.col(1) = c * R.col(1) - s * x;
  }
  along.p = p + R * p_end_;
  along.R.noalias() = R * R_end_;
}

Vector6 RegionConstraint::excess(const Sweep& along, bool& flipped) const {
  Vector6 result;
  for (Eigen::Index i = 0; i < 3; ++i)
    result[i] = beyond(along.p[i], region_bounds_(0, i), region_bounds_(1, i));
  const Eigen::Matrix3d& R = along.R;
  const double roll = std::atan2(R(2, 1), R(2, 2));
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  const double yaw = std::isinf(region_bounds_(0, 5)) ? 0 : std::atan2(R(1, 0), R(0, 0));
  const AngleExcess angles = angle_excess({roll, pitch, yaw}, region_bounds_.rightCols<3>());
  result.tail<3>() = angles.beyond;
  flipped = angles.is_flipped;
  return result;
}

Vector6 RegionConstraint::excess(const Eigen::VectorXd& q) const {
  if (tilt_) {
    Vector6 result = Vector6::Zero();
    result.segment<2>(3) = tilt_->excess(q);
    return result;
  }
  Sweep along;
  sweep(q, along);
  bool flipped = false;
  return excess(along, flipped);
}

void RegionConstraint::derive(const Sweep& along, bool flipped, Matrix6& derivative) const {
  const Eigen::Matrix3d& R = along.R;
  const double cos_pitch = std::max(std::hypot(R(0, 0), R(1, 0)), kMinCosine);
  const double sin_pitch = -R(2, 0);
  const double cos_yaw = R(0, 0) / cos_pitch, sin_yaw = R(1, 0) / cos_pitch;
  Eigen::Matrix3d rates;  // of roll, pitch, yaw, per angular velocity
  rates << cos_yaw / cos_pitch, sin_yaw / cos_pitch, 0,  //
      -sin_yaw, cos_yaw, 0,                              //
      cos_yaw * sin_pitch / cos_pitch, sin_yaw * sin_pitch / cos_pitch, 1;
  if (flipped)
    rates.row(1) = -rates.row(1);
  derivative.resize(6, along.axes.cols());
  for (Eigen::Index i = 0; i < along.axes.cols(); ++i) {
    const Eigen::Vector3d axis = along.axes.col(i);
    if (segments_[static_cast<std::size_t>(i)].prismatic) {
      derivative.col(i) << axis, Eigen::Vector3d::Zero();
      continue;
    }
    derivative.col(i).head<3>() = axis.cross(along.p - along.origins.col(i));
    derivative.col(i).tail<3>().noalias() = rates * axis;
  }
}

RegionConstraint::Matrix6 RegionConstraint::derivative(const Eigen::VectorXd& q) const {
  Sweep along;
  sweep(q, along);
  bool flipped = false;
  excess(along, flipped);
  Matrix6 result;
  derive(along, flipped, result);
  return result;
}

bool RegionConstraint::project(Eigen::VectorXd& q) {
  ++projections_;
  if (tilt_)
    return tilt_->project(bounds_, q);
  Sweep along;
  Matrix6 J;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, kMaxJoints> active;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1> residual;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> normal;
  for (int iteration = 0;; ++iteration) {
    sweep(q, along);
    bool flipped = false;
    const Vector6 outside = excess(along, flipped);
    if (outside.squaredNorm() <= kAimed * kAimed)
      return true;
    if (iteration == kMaxIterations)
      return false;
    derive(along, flipped, J);
    const Eigen::Index count = (outside.array() != 0).count();
    active.resize(count, q.size());
    residual.resize(count);
    for (Eigen::Index i = 0, row = 0; i < 6; ++i)
      if (outside[i] != 0) {
        active.row(row) = J.row(i);
        residual[row++] = outside[i] + std::copysign(margin_[i], outside[i]);
      }
    normal.noalias() = active.lazyProduct(active.transpose());
    normal.diagonal().array() += kSquaredDamping;
    normal.llt().solveInPlace(residual);
    q -= active.transpose().lazyProduct(residual);
    q = q.cwiseMax(bounds_.row(0).transpose()).cwiseMin(bounds_.row(1).transpose());
  }
}

ConstrainedStepper::ConstrainedStepper(double step, RegionConstraint& constraint)
    : step_(step), constraint_(constraint) {}

bool ConstrainedStepper::within_tolerance_between(const Eigen::VectorXd& q,
                                                  const Eigen::VectorXd& other) {
  // Between two configurations of the region the excess is nearly a parabola: largest midway.
  constexpr double kMargin = 0.9;
  middle_ = 0.5 * (q + other);
  return constraint_.distance(middle_) <= kMargin * RegionConstraint::kBetweenTolerance;
}

bool ConstrainedStepper::joins(const Eigen::VectorXd& q, const Eigen::VectorXd& other) {
  return (other - q).norm() <= step_ + kRounding && within_tolerance_between(q, other);
}

bool ConstrainedStepper::advance(const Eigen::VectorXd& q, const Eigen::VectorXd& target,
                                 Eigen::VectorXd& next) {
  const double distance = (target - q).norm();
  double stride = std::min(step_, distance);
  for (int halving = 0; halving <= kHalvings; ++halving, stride /= 2) {
    next = q + (stride / distance) * (target - q);
    if (!constraint_.project(next))
      continue;
    if ((next - q).norm() < kMinProgress * stride || (next - target).norm() >= distance - kRounding)
      return false;
    if (joins(q, next))
      return true;
  }
  return false;
}

std::optional<Eigen::MatrixXd> ConstrainedStepper::way_through(const Eigen::MatrixXd& waypoints) {
  std::vector<Eigen::MatrixXd> pieces;
  Eigen::Index count = 1;
  for (Eigen::Index i = 1; i < waypoints.cols(); ++i) {
    auto piece = way(waypoints.col(i - 1), waypoints.col(i));
    if (!piece)
      return std::nullopt;
    count += piece->cols() - 1;
    pieces.push_back(*std::move(piece));
  }
  Eigen::MatrixXd whole(waypoints.rows(), count);
  whole.col(0) = waypoints.col(0);
  Eigen::Index at = 1;
  for (const Eigen::MatrixXd& piece : pieces) {
    whole.middleCols(at, piece.cols() - 1) = piece.rightCols(piece.cols() - 1);
    at += piece.cols() - 1;
  }
  return whole;
}

std::optional<Eigen::MatrixXd> ConstrainedStepper::way(const Eigen::VectorXd& from,
                                                       const Eigen::VectorXd& to) {
  std::vector<Eigen::VectorXd> passed = {from};
  Eigen::VectorXd next(from.size());
  while (passed.back() != to) {
    if (joins(passed.back(), to))
      next = to;
    else if (!advance(passed.back(), to, next))
      return std::nullopt;
    passed.push_back(next);
  }
  Eigen::MatrixXd way(from.size(), static_cast<Eigen::Index>(passed.size()));
  for (std::size_t i = 0; i < passed.size(); ++i)
    way.col(static_cast<Eigen::Index>(i)) = passed[i];
  return way;
}

}  // namespace kinship::planning
