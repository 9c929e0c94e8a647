#include "robots/planning/region_angles.hpp"

#include <algorithm>
#include <cmath>

#include "proto/types/turn.hpp"

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

}  // namespace kinship::planning
