#include "proto/types/task_space_region.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "proto/types/number_text.hpp"

namespace kinship {
namespace {

bool is_rigid(const Eigen::Isometry3d& T) {
  constexpr double kTolerance = 1e-6;
  const Eigen::Matrix3d R = T.linear();
  return T.matrix().allFinite() && R.isUnitary(kTolerance) && R.determinant() > 0;
}

}  // namespace

const char* displacement_name(Eigen::Index coordinate) {
  constexpr std::array<const char*, 6> kNames = {"x", "y", "z", "roll", "pitch", "yaw"};
  return kNames.at(static_cast<std::size_t>(coordinate));
}

std::optional<std::string> validate(const TaskSpaceRegion& region) {
  if (!is_rigid(region.T_task_region))
    return "T0_w is not a rigid transform";
  if (!is_rigid(region.T_region_end))
    return "Tw_e is not a rigid transform";
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < region.bounds.cols(); ++i) {
    const double lower = region.bounds(0, i), upper = region.bounds(1, i);
    const std::string name = std::string("Bw of ") + displacement_name(i) + ": ";
    if (std::isnan(lower) || std::isnan(upper))
      return name + "is not a number";
    if (lower > upper)
      return name + "lower " + number_text(lower) + " exceeds upper " + number_text(upper);
    const bool half_open_angle = i >= 3 && std::isfinite(lower) != std::isfinite(upper);
    if (half_open_angle && (lower > M_PI || upper < -M_PI))
      return name + "beyond half a turn needs both bounds";
    if (lower == kInfinity || upper == -kInfinity)
      return name + "excludes everything";
  }
  return std::nullopt;
}

}  // namespace kinship
