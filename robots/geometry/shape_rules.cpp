#include "robots/geometry/shape_rules.hpp"

#include <sstream>

namespace kinship::geometry {
namespace {

using Broken = std::optional<std::string>;

Broken check(const char* name, double value_m) {
  if (value_m > 0 && value_m <= kMaxShape_m)
    return std::nullopt;  // false for NaN
  std::ostringstream text;
  text << name << " of " << value_m << " m is not between 0 and " << kMaxShape_m << " m";
  return text.str();
}

struct Checker {
  Broken operator()(const BoxShape& box) const {
    for (const double extent : {box.size.x(), box.size.y(), box.size.z()})
      if (auto why = check("box extent", extent))
        return why;
    return std::nullopt;
  }
  Broken operator()(const CylinderShape& cylinder) const {
    if (auto why = check("cylinder radius", cylinder.radius_m))
      return why;
    return check("cylinder length", cylinder.length_m);
  }
  Broken operator()(const SphereShape& sphere) const {
    return check("sphere radius", sphere.radius_m);
  }
  Broken operator()(const CapsuleShape& capsule) const {
    if (auto why = check("capsule radius", capsule.radius_m))
      return why;
    if (capsule.length_m == 0)
      return std::nullopt;
    return check("capsule length", capsule.length_m);
  }
};

struct HalfExtents {
  Eigen::Vector3d operator()(const BoxShape& box) const { return box.size / 2; }
  Eigen::Vector3d operator()(const CylinderShape& cylinder) const {
    return {cylinder.radius_m, cylinder.radius_m, cylinder.length_m / 2};
  }
  Eigen::Vector3d operator()(const SphereShape& sphere) const {
    return Eigen::Vector3d::Constant(sphere.radius_m);
  }
  Eigen::Vector3d operator()(const CapsuleShape& capsule) const {
    return {capsule.radius_m, capsule.radius_m, capsule.length_m / 2 + capsule.radius_m};
  }
};

}  // namespace

Broken broken_rule(const Shape& shape) { return std::visit(Checker{}, shape); }

Eigen::Vector3d half_extents_m(const Shape& shape) { return std::visit(HalfExtents{}, shape); }

}  // namespace kinship::geometry
