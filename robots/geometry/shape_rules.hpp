#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "proto/types/scene.hpp"

namespace kinship::geometry {

/// Largest extent, radius or length of a shape, m.
inline constexpr double kMaxShape_m = 1000.0;

/// Why a shape is invalid: a size that is not finite, not positive or above kMaxShape_m, with its
/// value. A capsule may have length 0. Empty if the shape is sound.
std::optional<std::string> broken_rule(const Shape& shape);

/// Half the edges of the smallest box in the shape's own frame that holds it, m.
Eigen::Vector3d half_extents_m(const Shape& shape);

}  // namespace kinship::geometry
