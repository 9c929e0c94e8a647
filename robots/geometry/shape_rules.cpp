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

}  // namespace

Broken broken_rule(const Shape& shape) { return std::visit(Checker{}, shape); }

}  // namespace kinship::geometry
