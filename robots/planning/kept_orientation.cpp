#include "robots/planning/kept_orientation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace kinship::planning {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

constexpr double kRounding_rad = 1e-9;

std::string short_number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

/// The largest bound of two turns beside a free one under which the tilt stays within `tolerance`.
/// A box of s and s tilts by sqrt(2) s at most; a rotation vector is up to pi / 2 times its tilt.
double bound_beside_free(double tolerance, bool is_vector) {
  return tolerance / std::numbers::sqrt2 / (is_vector ? std::numbers::pi / 2 : 1);
}

Eigen::Vector3d message_angles(const Eigen::Vector3d& rpy, bool is_vector) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  const Eigen::Quaterniond turn = AngleAxisd(rpy.z(), Vector3d::UnitZ()) *
                                  AngleAxisd(rpy.y(), Vector3d::UnitY()) *
                                  AngleAxisd(rpy.x(), Vector3d::UnitX());
  if (is_vector) {
    const AngleAxisd vector(turn);
    return vector.angle() * vector.axis();
  }
  const Eigen::Matrix3d R = turn.toRotationMatrix();
  return {std::atan2(-R(1, 2), R(2, 2)), std::asin(std::clamp(R(0, 2), -1.0, 1.0)),
          std::atan2(-R(0, 1), R(0, 0))};
}

/// Whether all orientations of a box of roll, pitch and yaw within `bounds`, below pi / 2, are
/// within the tolerances. One beyond would be on the box's surface: inside both kinds of angles
/// change with the orientation in each direction. Half a turn about x, y or z changes the signs of
/// two angles of each kind, so three half faces stand for all six.
bool is_box_within(const Eigen::Vector3d& bounds, const Eigen::Vector3d& tolerances,
                   bool is_vector) {
  constexpr int kSteps = 8;  // from the middle of an edge to its end
  for (Eigen::Index face = 0; face < 3; ++face)
    for (int i = 0; i <= kSteps; ++i)
      for (int j = -kSteps; j <= kSteps; ++j) {
        Eigen::Vector3d rpy = bounds;
        rpy[(face + 1) % 3] *= static_cast<double>(i) / kSteps;
        rpy[(face + 2) % 3] *= static_cast<double>(j) / kSteps;
        const Eigen::Array3d beyond =
            message_angles(rpy, is_vector).array().abs() - tolerances.array();
        if ((beyond > kRounding_rad).any())
          return false;
      }
  return true;
}

/// The tolerances made smaller alike, as far as it needs.
Eigen::Vector3d bounds_within(const Eigen::Vector3d& tolerances, bool is_vector) {
  constexpr double kLargest_rad = 1.5;    // the angles of both kinds are unique below pi / 2
  constexpr double kBetweenSteps = 0.99;  // a box's surface is looked at in steps
  constexpr int kHalvings = 12;
  const Eigen::Vector3d largest = tolerances.cwiseMin(kLargest_rad);
  if ((largest.array() > 0).count() <= 1)
    return largest;  // one turn: it has no order
  double within = 0, beyond = 1;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (within + beyond);
    (is_box_within(middle * largest, tolerances, is_vector) ? within : beyond) = middle;
  }
  return kBetweenSteps * within * largest;
}

}  // namespace

Result<KeptOrientation> keep_orientation(Eigen::Vector3d tolerances, bool is_rotation_vector) {
  if (!(tolerances.array() >= 0).all())
    return Error{ErrorCode::InvalidInput, "tolerances of an orientation must not be below 0"};
  tolerances = (tolerances.array() >= std::numbers::pi).select(kUnbounded, tolerances);
  const auto free = (tolerances.array() == kUnbounded).count();
  if (free == 3)
    return KeptOrientation{tolerances, {}};
  if (free == 2 || tolerances.y() == kUnbounded)
    return Error{ErrorCode::InvalidInput,
                 "with the turn about y or about two axes free the tolerances bound no tilt; "
                 "leave the turn about x or z alone free"};
  const std::string told = "orientation to be kept: its turns have another order";
  if (free == 0) {
    const Eigen::Vector3d bounds = bounds_within(tolerances, is_rotation_vector);
    if (bounds == tolerances)
      return KeptOrientation{bounds, {}};
    return KeptOrientation{bounds, told + ", so that its tolerances become " +
                                       short_number(bounds.x()) + ", " + short_number(bounds.y()) +
                                       " and " + short_number(bounds.z()) +
                                       ": every orientation within is within those asked for"};
  }
  const double bound = bound_beside_free(tolerances.minCoeff(), is_rotation_vector);
  return KeptOrientation{(tolerances.array() == kUnbounded).select(tolerances, bound),
                         told + ", so that its tolerances become " + short_number(bound) +
                             ": every tilt within is within " +
                             short_number(tolerances.minCoeff())};
}

}  // namespace kinship::planning
