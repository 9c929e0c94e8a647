#include "robots/planning/kept_orientation.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <numbers>

namespace kinship::planning {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

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
    std::array<double, 3> sorted = {tolerances.x(), tolerances.y(), tolerances.z()};
    std::ranges::sort(sorted);
    return KeptOrientation{tolerances,
                           told + ", within " + short_number(sorted[1] * sorted[2]) + " rad"};
  }
  const double bound = bound_beside_free(tolerances.minCoeff(), is_rotation_vector);
  return KeptOrientation{(tolerances.array() == kUnbounded).select(tolerances, bound),
                         told + ", so that its tolerances become " + short_number(bound) +
                             ": every tilt within is within " +
                             short_number(tolerances.minCoeff())};
}

}  // namespace kinship::planning
