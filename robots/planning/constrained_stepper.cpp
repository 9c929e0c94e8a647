#include "robots/planning/constrained_stepper.hpp"

#include <algorithm>
#include <vector>

namespace kinship::planning {
namespace {

constexpr double kRounding = 1e-9;  // joint units
/// Of a stride: a projection that takes back more has met the end of the way along the region.
constexpr double kMinProgress = 0.2;
constexpr int kHalvings = 2;

}  // namespace

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
