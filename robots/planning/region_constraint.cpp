#include "robots/planning/region_constraint.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <bit>
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

/// Joint after joint, kSideBySide values each; behind the last column it is repeated.
struct LaneConfigurations {
  explicit LaneConfigurations(const Eigen::Ref<const Eigen::MatrixXd>& qs) {
    for (Eigen::Index joint = 0; joint < qs.rows(); ++joint)
      for (Eigen::Index lane = 0; lane < kSideBySide; ++lane)
        values[joint * kSideBySide + lane] =
            static_cast<float>(qs(joint, std::min(lane, qs.cols() - 1)));
  }
  alignas(32) float values[kLaneJoints * kSideBySide];
};

unsigned first_bits(Eigen::Index count) { return (1U << count) - 1; }

constexpr double kRounding = 1e-9;  // joint units
/// Of a stride: a projection that takes back more has met the end of the way along the region.
constexpr double kMinProgress = 0.2;
constexpr int kHalvings = 2;
/// Between two configurations of the region the excess is nearly a parabola: largest midway.
constexpr double kMostBetween = 0.9 * RegionConstraint::kBetweenTolerance;

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
  fill_lanes();
}

void RegionConstraint::fill_lanes() {
  const auto put = [](const Eigen::Matrix3d& R, const Eigen::Vector3d& p, float* R_lane,
                      float* p_lane) {
    for (Eigen::Index row = 0; row < 3; ++row) {
      p_lane[row] = static_cast<float>(p[row]);
      for (Eigen::Index column = 0; column < 3; ++column)
        R_lane[3 * row + column] = static_cast<float>(R(row, column));
    }
  };
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    LaneRegion::Joint& joint = lanes_.joints[i];
    put(segments_[i].R, segments_[i].p, joint.R, joint.p);
    joint.slides = segments_[i].prismatic;
    const auto column = bounds_.col(static_cast<Eigen::Index>(i));
    lanes_.least[i] = std::nextafter(static_cast<float>(column[0]), kInfinity);  // inside
    lanes_.most[i] = std::nextafter(static_cast<float>(column[1]), -kInfinity);
  }
  lanes_.dof = static_cast<int>(segments_.size());
  put(R_end_, p_end_, lanes_.R_end, lanes_.p_end);
  for (int i = 0; i < 6; ++i) {
    lanes_.lower[i] = static_cast<float>(region_bounds_(0, i));
    lanes_.upper[i] = static_cast<float>(region_bounds_(1, i));
    lanes_.margin[i] = static_cast<float>(margin_[i]);
    if (std::isfinite(region_bounds_(0, i)) || std::isfinite(region_bounds_(1, i)))
      lanes_.rows[lanes_.row_count++] = i;
  }
  lanes_.has_place = lanes_.row_count > 0 && lanes_.rows[0] < 3;
  lanes_.aimed_squared = static_cast<float>(kAimed * kAimed);
  lanes_.squared_damping = static_cast<float>(kSquaredDamping);
  lanes_.least_cosine = static_cast<float>(kMinCosine);
}

unsigned RegionConstraint::project_together(Eigen::Ref<Eigen::MatrixXd> qs) const {
  if (qs.cols() == 0)
    return 0;
  LaneConfigurations lanes(qs);
  const unsigned arrived = fastest_region_kernels().project(lanes_, lanes.values);
  for (Eigen::Index lane = 0; lane < qs.cols(); ++lane)
    for (Eigen::Index joint = 0; joint < qs.rows(); ++joint)
      qs(joint, lane) = lanes.values[joint * kSideBySide + lane];
  return arrived & first_bits(qs.cols());
}

unsigned RegionConstraint::hold_together(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                                         double distance) const {
  if (qs.cols() == 0)
    return 0;
  const LaneConfigurations lanes(qs);
  float squared[kSideBySide];
  fastest_region_kernels().measure(lanes_, lanes.values, squared);
  unsigned within = 0;
  for (Eigen::Index lane = 0; lane < qs.cols(); ++lane)
    within |= squared[lane] <= static_cast<float>(distance * distance) ? 1U << lane : 0U;
  return within;
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

bool ConstrainedStepper::is_step(const Eigen::Ref<const Eigen::VectorXd>& q,
                                 const Eigen::Ref<const Eigen::VectorXd>& next,
                                 const Eigen::Ref<const Eigen::VectorXd>& target,
                                 double stride) const {
  const double made = (next - q).norm();
  return made >= kMinProgress * stride && made <= step_ + kRounding &&
         (next - target).norm() < (q - target).norm() - kRounding;
}

unsigned ConstrainedStepper::advance_together(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                                              const Eigen::Ref<const Eigen::MatrixXd>& targets,
                                              Eigen::Ref<Eigen::MatrixXd> next) {
  std::array<double, kSideBySide> distances{};
  for (Eigen::Index i = 0; i < qs.cols(); ++i) {
    double& distance = distances[static_cast<std::size_t>(i)];
    distance = (targets.col(i) - qs.col(i)).norm();
    next.col(i) = qs.col(i) + std::min(step_ / distance, 1.0) * (targets.col(i) - qs.col(i));
  }
  constraint_.set_projections(constraint_.projections() + static_cast<std::uint64_t>(qs.cols()));
  unsigned steps = constraint_.project_together(next);
  for (Eigen::Index i = 0; i < qs.cols(); ++i) {
    const double stride = std::min(step_, distances[static_cast<std::size_t>(i)]);
    if (!is_step(qs.col(i), next.col(i), targets.col(i), stride))
      steps &= ~(1U << i);
  }
  middles_.resize(qs.rows(), kSideBySide);
  middles_.leftCols(qs.cols()) = 0.5 * (qs + next);
  return steps & constraint_.hold_together(middles_.leftCols(qs.cols()), kMostBetween);
}

Eigen::Index ConstrainedStepper::advance_ahead(const Eigen::VectorXd& q,
                                               const Eigen::VectorXd& target,
                                               Eigen::Ref<Eigen::MatrixXd> steps) {
  const double distance = (target - q).norm();
  const Eigen::Index count = std::min<Eigen::Index>(
      kSideBySide, static_cast<Eigen::Index>(std::ceil(distance / step_ - kRounding)));
  for (Eigen::Index i = 0; i < count; ++i)
    steps.col(i) = q + std::min(static_cast<double>(i + 1) * step_ / distance, 1.0) * (target - q);
  const unsigned arrived = constraint_.project_together(steps.leftCols(count));
  Eigen::Index made = 0;
  middles_.resize(q.size(), kSideBySide);
  for (; made < count && (arrived >> made & 1U) != 0; ++made) {
    const Eigen::Ref<const Eigen::VectorXd> last =
        made == 0 ? Eigen::Ref<const Eigen::VectorXd>(q) : steps.col(made - 1);
    const double stride = std::min(step_, distance - static_cast<double>(made) * step_);
    if (!is_step(last, steps.col(made), target, stride))
      break;
    middles_.col(made) = 0.5 * (last + steps.col(made));
  }
  const unsigned held = constraint_.hold_together(middles_.leftCols(made), kMostBetween);
  made = std::min<Eigen::Index>(made, std::countr_one(held));
  constraint_.set_projections(constraint_.projections() + static_cast<std::uint64_t>(made));
  return made;
}

bool ConstrainedStepper::within_tolerance_between(const Eigen::VectorXd& q,
                                                  const Eigen::VectorXd& other) {
  middle_ = 0.5 * (q + other);
  return constraint_.distance(middle_) <= kMostBetween;
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
