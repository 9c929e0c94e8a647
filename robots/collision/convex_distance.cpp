#include "robots/collision/convex_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kinship::collision {
namespace {

constexpr int kMaxGjkIterations = 64;
constexpr double kGjkRelative = 0.01,
                 kGjkAbsolute_m = 1e-6;  // how near the bound comes to the distance
constexpr double kGjkRounding_m = 1e-9;

/// A shape as a smaller one, all points within `radius_m` of which are the shape.
struct Core {
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  // of a box; of a line, which has only a z
  double disc_m = 0;                               // of a cylinder, whose half length is half.z
  double radius_m = 0;
};

Core core_of(const Shape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape))
    return {box->size / 2, 0, 0};
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return {{0, 0, cylinder->length_m / 2}, cylinder->radius_m, 0};
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return {Eigen::Vector3d::Zero(), 0, sphere->radius_m};
  const auto& capsule = std::get<CapsuleShape>(shape);
  return {{0, 0, capsule.length_m / 2}, 0, capsule.radius_m};
}

/// The point of a core that is farthest along a direction, in the core's frame.
Eigen::Vector3d farthest(const Core& core, const Eigen::Vector3d& direction) {
  Eigen::Vector3d point(std::copysign(core.half.x(), direction.x()),
                        std::copysign(core.half.y(), direction.y()),
                        std::copysign(core.half.z(), direction.z()));
  if (core.disc_m > 0) {
    const double across = std::hypot(direction.x(), direction.y());
    if (across > 0)
      point.head<2>() = core.disc_m / across * direction.head<2>();
  }
  return point;
}

/// Points of the difference of two cores, at most four, that span its part nearest to the origin.
struct Simplex {
  std::array<Eigen::Vector3d, 4> points;
  int count = 0;

  void add(const Eigen::Vector3d& point) { points[static_cast<std::size_t>(count++)] = point; }
};

/// A point, and the least simplex that holds it.
struct Nearest {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Simplex simplex;
};

Nearest nearest_of(const Eigen::Vector3d& a) {
  Nearest nearest{a, {}};
  nearest.simplex.add(a);
  return nearest;
}

Nearest nearest_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d side = b - a;
  const double along = -a.dot(side), length2 = side.squaredNorm();
  if (along <= 0 || length2 <= 0)
    return nearest_of(a);
  if (along >= length2)
    return nearest_of(b);
  Nearest nearest{a + along / length2 * side, {}};
  nearest.simplex.add(a);
  nearest.simplex.add(b);
  return nearest;
}

const Nearest& nearer(const Nearest& first, const Nearest& second) {
  return second.point.squaredNorm() < first.point.squaredNorm() ? second : first;
}

Nearest nearest_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double area2 = normal.squaredNorm();
  const bool is_inside = area2 > 0 && normal.dot(a.cross(b)) >= 0 && normal.dot(b.cross(c)) >= 0 &&
                         normal.dot(c.cross(a)) >= 0;
  if (!is_inside)
    return nearer(nearer(nearest_of(a, b), nearest_of(b, c)), nearest_of(c, a));
  Nearest nearest{a.dot(normal) / area2 * normal, {}};
  for (const Eigen::Vector3d& point : {a, b, c})
    nearest.simplex.add(point);
  return nearest;
}

/// \return with four points if the origin lies within them.
Nearest nearest_of(const Simplex& simplex) {
  const auto& [a, b, c, d] = simplex.points;
  if (simplex.count == 1)
    return nearest_of(a);
  if (simplex.count == 2)
    return nearest_of(a, b);
  if (simplex.count == 3)
    return nearest_of(a, b, c);
  Nearest best{Eigen::Vector3d::Constant(std::numeric_limits<double>::max()), {}};
  bool is_outside = false;
  const auto look_at = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                           const Eigen::Vector3d& r, const Eigen::Vector3d& opposite) {
    const Eigen::Vector3d normal = (q - p).cross(r - p);
    if (normal.dot(opposite - p) * normal.dot(p) < 0)
      return;  // the origin is on the inner side
    is_outside = true;
    const Nearest nearest = nearest_of(p, q, r);
    if (nearest.point.squaredNorm() < best.point.squaredNorm())
      best = nearest;
  };
  look_at(a, b, c, d);
  look_at(a, b, d, c);
  look_at(a, c, d, b);
  look_at(b, c, d, a);
  return is_outside ? best : Nearest{Eigen::Vector3d::Zero(), simplex};
}

}  // namespace

double convex_distance_m(const Shape& a, const Eigen::Isometry3d& T_base_a, const Shape& b,
                         const Eigen::Isometry3d& T_base_b, double enough_m) {
  const Core core_a = core_of(a), core_b = core_of(b);
  const double radii_m = core_a.radius_m + core_b.radius_m;
  const Eigen::Matrix3d R_a_b = T_base_a.linear().transpose() * T_base_b.linear();
  const Eigen::Vector3d p_a_b =
      T_base_a.linear().transpose() * (T_base_b.translation() - T_base_a.translation());
  Eigen::Vector3d nearest = -p_a_b;  // of the points of a minus those of b, to the origin
  Simplex simplex;
  double bound_m = 0;
  for (int i = 0; i < kMaxGjkIterations; ++i) {
    const double above_m = nearest.norm();
    if (above_m <= radii_m + kGjkRounding_m)
      return 0;
    const Eigen::Vector3d toward = -nearest / above_m;
    const Eigen::Vector3d point = farthest(core_a, toward) -
                                  (p_a_b + R_a_b * farthest(core_b, -(R_a_b.transpose() * toward)));
    bound_m = std::max(bound_m, -toward.dot(point));
    if (above_m - bound_m <= std::max(kGjkAbsolute_m, kGjkRelative * (bound_m - radii_m)) ||
        bound_m - radii_m - kGjkRounding_m >= enough_m)
      break;
    simplex.add(point);
    const Nearest next = nearest_of(simplex);
    if (next.simplex.count == 4)
      return 0;
    if (simplex.count > 1 && next.point.norm() >= above_m - kGjkRounding_m / 10)
      break;  // no nearer: rounding
    simplex = next.simplex;
    nearest = next.point;
  }
  return std::max(bound_m - radii_m - kGjkRounding_m, 0.0);
}

}  // namespace kinship::collision
