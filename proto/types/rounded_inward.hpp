#pragma once

#include <cmath>
#include <limits>

namespace kinship {

/// A number to be kept in half the bytes: the nearest f32, or, where that lies beyond a limit that
/// the number keeps, the next one on this side of it. Where no f32 lies within the limits the
/// nearest one stands.
/// \param lower, upper  any unit, or infinite; a number outside them is only rounded.
inline float rounded_inward(double number, double lower, double upper) noexcept {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto nearest = static_cast<float>(number);
  if (number <= upper && static_cast<double>(nearest) > upper) {
    const float below = std::nextafter(nearest, -kInfinity);
    return static_cast<double>(below) < lower ? nearest : below;
  }
  if (number >= lower && static_cast<double>(nearest) < lower) {
    const float above = std::nextafter(nearest, kInfinity);
    return static_cast<double>(above) > upper ? nearest : above;
  }
  return nearest;
}

}  // namespace kinship
