#pragma once

#include <vector>

#include "robots/geometry/link_shapes.hpp"

namespace kinship::geometry {

/// How far radii and centres may be off for a cylinder and two spheres to count as one capsule, m.
inline constexpr double kFusionTolerance_m = 1e-5;

/// Replaces each cylinder that has a sphere of its radius at both ends, on the same link, by the
/// capsule that the three make up, and drops those spheres. URDF has no capsule of its own.
/// Two capsules may share an end sphere. The order of what remains is kept.
std::vector<LinkShape> fuse_capsules(const std::vector<LinkShape>& shapes);

}  // namespace kinship::geometry
