#pragma once

#include <vector>

#include "robots/geometry/link_shapes.hpp"

namespace kinship::geometry {

/// Tolerance of radii and centres for a cylinder and two spheres to count as one capsule, m.
inline constexpr double kFusionTolerance_m = 1e-5;

/// Replaces each cylinder that has a sphere of its radius at both ends, on the same link, by the
/// capsule that the three make up, and drops the spheres. URDF has no capsule of its own. Two
/// capsules may share an end sphere. The other shapes keep their order.
std::vector<LinkShape> fuse_capsules(const std::vector<LinkShape>& shapes);

}  // namespace kinship::geometry
