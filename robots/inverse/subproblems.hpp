#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "robots/inverse/axis.hpp"

/// The few problems that closed forms are put together from: angles about one or two axes that
/// bring a point or a direction to where it is wanted. Lengths in units of the arm's size. Where
/// every angle would do, 0 stands for all; nothing here is ever NaN for finite input.
///
/// Source: Paden, Kinematics and control of robot manipulators (1986); Murray, Li and Sastry, A
/// mathematical introduction to robotic manipulation (1994), section 3.3; Elias and Wen, IK-Geo:
/// unified robot inverse kinematics using subproblem decomposition (2025).
namespace kinship::inverse {

/// Up to two angles.
struct Angles {
  std::array<double, 2> values{};
  int count = 0;

  const double* begin() const { return values.data(); }
  const double* end() const { return values.data() + count; }
};

inline constexpr double kSingular = 1e-8;  ///< shorter: a direction that means nothing
inline constexpr double kDouble = 1e-14;   ///< two angles closer than its root are one

/// The angles with a cos + b sin = c.
/// \param slack  share of the amplitude by which c may exceed it: the nearest angle stands then.
inline Angles solve_cosine(double a, double b, double c, double slack) {
  const double amplitude = std::hypot(a, b);
  if (amplitude < kSingular) {
    if (std::abs(c) <= kSingular + slack)
      return {{0, 0}, 1};
    return {};
  }
  const double middle = std::atan2(b, a);
  const double squared = (amplitude - c) * (amplitude + c);
  if (squared <= kDouble * amplitude * amplitude) {
    if (std::abs(c) > amplitude * (1 + slack))
      return {};
    return {{c > 0 ? middle : middle + std::numbers::pi, 0}, 1};
  }
  const double half = std::atan2(std::sqrt(squared), c);
  return {{middle + half, middle - half}, 2};
}

/// The angle about a unit vector that turns `from` towards `to` (their parts across it).
inline double angle_about(const Eigen::Vector3d& direction, const Eigen::Vector3d& from,
                          const Eigen::Vector3d& to) {
  const double sine = direction.dot(from.cross(to));
  const double cosine = from.dot(to) - direction.dot(from) * direction.dot(to);
  if (sine * sine + cosine * cosine < kSingular * kSingular * from.squaredNorm() * to.squaredNorm())
    return 0;
  return std::atan2(sine, cosine);
}

/// `v` turned about a unit vector.
inline Eigen::Vector3d turned(const Eigen::Vector3d& direction, double angle,
                              const Eigen::Vector3d& v) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return c * v + s * direction.cross(v) + ((1 - c) * direction.dot(v)) * direction;
}

/// A point turned about an axis.
inline Eigen::Vector3d turned(const Axis& axis, double angle, const Eigen::Vector3d& x) {
  return axis.point + turned(axis.direction, angle, x - axis.point);
}

/// A turn about an axis that brings x to a distance from a centre, squared.
inline Angles turn_to_distance(const Axis& axis, const Eigen::Vector3d& x,
                               const Eigen::Vector3d& centre, double squared, double slack) {
  const Eigen::Vector3d foot = axis.foot_of(x);
  const Eigen::Vector3d arm = x - foot;
  const Eigen::Vector3d off = foot - centre;
  return solve_cosine(2 * off.dot(arm), 2 * off.dot(axis.direction.cross(arm)),
                      squared - off.squaredNorm() - arm.squaredNorm(), slack);
}

/// A turn about an axis that brings x into the plane `normal . y = height`.
inline Angles turn_to_height(const Axis& axis, const Eigen::Vector3d& x,
                             const Eigen::Vector3d& normal, double height, double slack) {
  const Eigen::Vector3d foot = axis.foot_of(x);
  const Eigen::Vector3d arm = x - foot;
  return solve_cosine(normal.dot(arm), normal.dot(axis.direction.cross(arm)),
                      height - normal.dot(foot), slack);
}

/// A turn of direction v about a unit vector after which `normal . v = cosine`.
inline Angles turn_direction(const Eigen::Vector3d& direction, const Eigen::Vector3d& v,
                             const Eigen::Vector3d& normal, double cosine, double slack) {
  const double along = direction.dot(v);
  return solve_cosine(normal.dot(v) - along * normal.dot(direction), normal.dot(direction.cross(v)),
                      cosine - along * normal.dot(direction), slack);
}

/// A turn about a first and a second axis: the second is carried along by the first.
struct TwoAngles {
  double first = 0;
  double second = 0;
};

struct TwoAnglePairs {
  std::array<TwoAngles, 2> values{};
  int count = 0;

  const TwoAngles* begin() const { return values.data(); }
  const TwoAngles* end() const { return values.data() + count; }
};

/// Turns about two axes through one point that bring x to y, both as seen from that point.
inline TwoAnglePairs turn_about_meeting(const Eigen::Vector3d& first, const Eigen::Vector3d& second,
                                        const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                                        double slack) {
  const double cosine = first.dot(second);
  const double sine_squared = 1 - cosine * cosine;
  if (sine_squared < kSingular * kSingular)  // one axis twice
    return {{TwoAngles{0, angle_about(second, x, y)}}, 1};
  // z, between the two turns, is on the cones about both axes.
  const double a = (first.dot(y) - cosine * second.dot(x)) / sine_squared;
  const double b = (second.dot(x) - cosine * first.dot(y)) / sine_squared;
  const Eigen::Vector3d across = first.cross(second);
  const Eigen::Vector3d middle = a * first + b * second;
  const double squared = (x.squaredNorm() - middle.squaredNorm()) / sine_squared;
  if (squared * sine_squared < -slack * x.squaredNorm())
    return {};
  const bool both = squared * sine_squared > kDouble * x.squaredNorm();
  const double off = both ? std::sqrt(squared) : 0;
  TwoAnglePairs pairs;
  for (const double sign : {1.0, -1.0}) {
    const Eigen::Vector3d z = middle + sign * off * across;
    pairs.values[static_cast<std::size_t>(pairs.count++)] = {angle_about(first, z, y),
                                                             angle_about(second, x, z)};
    if (!both)
      break;
  }
  return pairs;
}

/// Turns about two parallel axes that bring x to y, as far as the plane across them goes.
inline TwoAnglePairs turn_about_parallel(const Axis& first, const Axis& second,
                                         const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                                         double slack) {
  const Eigen::Vector3d wanted = y - first.foot_of(y);
  const Eigen::Vector3d foot = second.foot_of(x);
  const Eigen::Vector3d arm = x - foot;
  const Eigen::Vector3d off = foot - first.foot_of(foot);
  const Angles seconds =
      solve_cosine(2 * off.dot(arm), 2 * off.dot(second.direction.cross(arm)),
                   wanted.squaredNorm() - off.squaredNorm() - arm.squaredNorm(), slack);
  TwoAnglePairs pairs;
  for (const double angle : seconds) {
    const Eigen::Vector3d between = off + turned(second.direction, angle, arm);
    pairs.values[static_cast<std::size_t>(pairs.count++)] = {
        angle_about(first.direction, between, wanted), angle};
  }
  return pairs;
}

}  // namespace kinship::inverse
