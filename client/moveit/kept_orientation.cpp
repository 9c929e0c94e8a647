#include "client/moveit/kept_orientation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "client/moveit/geometry_messages.hpp"

namespace kinship::moveit {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

std::string short_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

Eigen::Vector3d read_tolerances(const YamlValue& constraint) {
  constexpr const char* kNames[] = {"absolute_x_axis_tolerance", "absolute_y_axis_tolerance",
                                    "absolute_z_axis_tolerance"};
  Eigen::Vector3d tolerances;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const YamlValue value = constraint[kNames[axis]];
    tolerances[axis] = value.number();
    if (tolerances[axis] < 0)
      value.refuse("'" + value.text() + "' is below 0");
    if (tolerances[axis] >= std::numbers::pi)
      tolerances[axis] = kUnbounded;
  }
  return tolerances;
}

/// Whether the tolerances are of a rotation vector; else of turns about x, y and z.
bool is_rotation_vector(const YamlValue& constraint) {
  const std::string kind = constraint["parameterization"].text_or("0");
  if (kind != "0" && kind != "1")
    constraint["parameterization"].refuse("'" + kind + "' is neither 0 nor 1");
  return kind == "1";
}

/// The largest bound of two turns beside a free one under which the tilt stays within `tolerance`.
/// A box of s and s tilts by sqrt(2) s at most; a rotation vector is up to pi / 2 times its tilt.
double bound_beside_free(double tolerance, bool is_vector) {
  return tolerance / std::numbers::sqrt2 / (is_vector ? std::numbers::pi / 2 : 1);
}

}  // namespace

std::optional<TaskSpaceRegion> read_kept_orientation(const YamlValue& constraint,
                                                     const Frames& frames,
                                                     std::vector<std::string>& left_out) {
  Eigen::Vector3d tolerances = read_tolerances(constraint);
  const bool is_vector = is_rotation_vector(constraint);
  const auto free = (tolerances.array() == kUnbounded).count();
  if (free == 3)
    return std::nullopt;
  if (free == 2 || tolerances.y() == kUnbounded)
    constraint.refuse(
        "with the turn about y or about two axes free the tolerances bound no tilt; "
        "leave the turn about x or z alone free");
  const std::string told = "orientation to be kept: its turns have another order";
  if (free == 1) {
    const double bound = bound_beside_free(tolerances.minCoeff(), is_vector);
    left_out.push_back(told + ", so that its tolerances become " + short_text(bound) +
                       ": every tilt within is within " + short_text(tolerances.minCoeff()));
    tolerances = (tolerances.array() == kUnbounded).select(tolerances, bound);
  } else {
    std::array<double, 3> sorted = {tolerances.x(), tolerances.y(), tolerances.z()};
    std::ranges::sort(sorted);
    left_out.push_back(told + ", within " + short_text(sorted[1] * sorted[2]) + " rad");
  }
  TaskSpaceRegion region;
  region.T_task_region.linear() = frames.T_task_header(constraint).linear() *
                                  read_rotation(constraint["orientation"]).toRotationMatrix();
  region.T_region_end = frames.T_link_transfer(constraint["link_name"]);
  Eigen::Vector<double, 6> upper = Eigen::Vector<double, 6>::Constant(kUnbounded);
  upper.tail<3>() = tolerances;
  region.bounds.row(0) = -upper;
  region.bounds.row(1) = upper;
  return region;
}

}  // namespace kinship::moveit
