#include "robots/inverse/joint_space.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "proto/types/turn.hpp"

namespace kinship::inverse {
namespace {

using kinematics::JointType;

constexpr double kRounder = 0x1.8p52;  // added and taken away it rounds to the nearest integer
constexpr double kSeam = 1e-8;         // rad: nearer to half a turn from mid-range is half a turn

/// As wrapped(), but for rounding, in a tenth of the time.
double rounded_turns_off(double angle) {
  const double turns = (angle * (1 / kTurn) + kRounder) - kRounder;
  return angle - turns * kTurn;
}

}  // namespace

JointSpace::Range::Range(const kinematics::Joint& joint)
    : lower(joint.lower),
      upper(joint.upper),
      middle(0.5 * (joint.lower + joint.upper)),
      half_drawn(0.5 * (joint.upper - joint.lower)),
      half_anywhere(joint.type == JointType::Prismatic ? 2 * half_drawn : std::numbers::pi),
      turns(joint.type != JointType::Prismatic),
      continuous(joint.type == JointType::Continuous) {
  if (turns)
    half_drawn = std::min(half_drawn, std::numbers::pi);
}

JointSpace::JointSpace(const kinematics::Chain& chain) {
  joints_.reserve(chain.joints().size());
  for (const kinematics::Joint& joint : chain.joints())
    joints_.emplace_back(joint);
}

bool JointSpace::normalize(double* q, double margin) const noexcept {
  bool inside = true;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Range& range = joints_[j];
    double value = q[j];
    if (range.turns)
      value = range.middle + rounded_turns_off(value - range.middle);
    // Half a turn to either side is one place: rounding must not make two solutions of it.
    if (range.turns && range.half_drawn >= std::numbers::pi - kLimitRounding &&
        value <= range.middle - std::numbers::pi + kSeam)
      value += kTurn;
    // Written so that NaN is outside.
    inside = inside && value >= range.lower - margin && value <= range.upper + margin;
    q[j] = inside ? std::clamp(value, range.lower, range.upper) : value;
  }
  return inside;
}

double JointSpace::squared_distance(const double* a, const double* b, double most) const noexcept {
  double squared = 0;
  for (std::size_t j = 0; j < joints_.size() && squared < most; ++j) {
    const double difference = joints_[j].continuous ? rounded_turns_off(a[j] - b[j]) : a[j] - b[j];
    squared += difference * difference;
  }
  return squared;
}

}  // namespace kinship::inverse
