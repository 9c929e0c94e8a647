#pragma once

#include <cmath>
#include <numbers>

namespace kinship {

inline constexpr double kTurn = 2 * std::numbers::pi;  ///< rad

/// An angle moved by whole turns into [-pi, pi].
inline double wrapped(double angle_rad) { return std::remainder(angle_rad, kTurn); }

}  // namespace kinship
