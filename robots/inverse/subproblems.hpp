#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "robots/inverse/axis.hpp"

/// The subproblems of closed forms: turns about one or two axes that bring a point or a direction
/// to a wanted place. Lengths in units of the arm's size. Where every turn is a solution, the zero
/// turn represents all; no result is NaN for finite input.
///
/// Source: Paden, Kinematics and control of robot manipulators (1986); Murray, Li and Sastry, A
/// mathematical introduction to robotic manipulation (1994), section 3.3; Elias and Wen, IK-Geo:
/// unified robot inverse kinematics using subproblem decomposition (2025).
namespace kinship::inverse {

inline constexpr double kSingular = 1e-8;  ///< a shorter direction is undefined
inline constexpr double kDouble = 1e-14;   ///< two turns closer than its root are one

/// A turn by an angle, as cosine and sine: a joint costs only one arc tangent, at the end.
struct Turn {
  double cosine = 1;
  double sine = 0;

  double angle() const { return std::atan2(sine, cosine); }  ///< in (-pi, pi]
  Turn back() const { return {cosine, -sine}; }
  Turn operator*(const Turn& next) const {
    return {cosine * next.cosine - sine * next.sine, sine * next.cosine + cosine * next.sine};
  }
};

/// The turns within a joint's limits, tested without an arc tangent.
struct TurnWindow {
  double cosine_middle = 1, sine_middle = 0;
  double cosine_half = -2;  ///< of the half range; below -1: any turn

  /// \param half  half the range, rad; pi and more: any turn.
  static TurnWindow around(double middle, double half) {
    if (half >= std::numbers::pi)
      return {};
    return {std::cos(middle), std::sin(middle), std::cos(half)};
  }

  bool holds(const Turn& turn) const {
    return turn.cosine * cosine_middle + turn.sine * sine_middle >= cosine_half;
  }
  TurnWindow back() const { return {cosine_middle, -sine_middle, cosine_half}; }
};

/// Up to two turns.
struct Turns {
  std::array<Turn, 2> values{};
  int count = 0;

  const Turn* begin() const { return values.data(); }
  const Turn* end() const { return values.data() + count; }
};

/// The turns with a cos + b sin = c.
/// \param slack  share of the amplitude by which c may exceed it: the result is then the nearest
///               turn.
inline Turns solve_cosine(double a, double b, double c, double slack) {
  const double amplitude = std::sqrt(a * a + b * b);
  if (amplitude < kSingular) {
    if (std::abs(c) <= kSingular + slack)
      return {{}, 1};
    return {};
  }
  const Turn middle{a / amplitude, b / amplitude};
  const double cosine = c / amplitude;
  const double sine_squared = (1 - cosine) * (1 + cosine);
  if (sine_squared <= kDouble) {
    if (std::abs(cosine) > 1 + slack)
      return {};
    return {{c > 0 ? middle : Turn{-middle.cosine, -middle.sine}}, 1};
  }
  const Turn half{cosine, std::sqrt(sine_squared)};
  return {{middle * half, middle * half.back()}, 2};
}

/// The turn about a unit vector that brings `from` towards `to` (their parts across it).
inline Turn turn_towards(const Eigen::Vector3d& direction, const Eigen::Vector3d& from,
                         const Eigen::Vector3d& to) {
  // Both parts across are taken first: near a singularity the products of the whole would cancel.
  const Eigen::Vector3d from_across = from - direction.dot(from) * direction;
  const Eigen::Vector3d to_across = to - direction.dot(to) * direction;
  const double cosine = from_across.dot(to_across);
  const double sine = direction.dot(from_across.cross(to_across));
  const double squared = cosine * cosine + sine * sine;
  constexpr double kSmallest = kSingular * kSingular * kSingular * kSingular;
  if (squared <= kSmallest * from.squaredNorm() * to.squaredNorm())
    return {};
  const double scale = 1 / std::sqrt(squared);
  return {cosine * scale, sine * scale};
}

/// `v` turned about a unit vector.
inline Eigen::Vector3d turned(const Eigen::Vector3d& direction, const Turn& turn,
                              const Eigen::Vector3d& v) {
  return turn.cosine * v + turn.sine * direction.cross(v) +
         ((1 - turn.cosine) * direction.dot(v)) * direction;
}

/// A point turned about an axis.
inline Eigen::Vector3d turned(const Axis& axis, const Turn& turn, const Eigen::Vector3d& x) {
  return axis.point + turned(axis.direction, turn, x - axis.point);
}

/// The rotation by a turn about a unit vector.
inline Eigen::Matrix3d rotation(const Eigen::Vector3d& direction, const Turn& turn) {
  const Eigen::Vector3d along = (1 - turn.cosine) * direction;
  const Eigen::Vector3d aside = turn.sine * direction;
  Eigen::Matrix3d R = along * direction.transpose();
  R.diagonal().array() += turn.cosine;
  R(0, 1) -= aside.z();
  R(1, 0) += aside.z();
  R(0, 2) += aside.y();
  R(2, 0) -= aside.y();
  R(1, 2) -= aside.x();
  R(2, 1) += aside.x();
  return R;
}

/// The displacement by a turn about an axis.
inline Displacement displacement(const Axis& axis, const Turn& turn) {
  const Eigen::Matrix3d R = rotation(axis.direction, turn);
  return {R, axis.point - R * axis.point};
}

/// The turns about an axis that bring x to a distance from a centre, squared.
inline Turns turn_to_distance(const Axis& axis, const Eigen::Vector3d& x,
                              const Eigen::Vector3d& centre, double squared, double slack) {
  const Eigen::Vector3d foot = axis.foot_of(x);
  const Eigen::Vector3d arm = x - foot;
  const Eigen::Vector3d off = foot - centre;
  return solve_cosine(2 * off.dot(arm), 2 * off.dot(axis.direction.cross(arm)),
                      squared - off.squaredNorm() - arm.squaredNorm(), slack);
}

/// The turns about an axis that bring x into the plane `normal . y = height`.
inline Turns turn_to_height(const Axis& axis, const Eigen::Vector3d& x,
                            const Eigen::Vector3d& normal, double height, double slack) {
  const Eigen::Vector3d foot = axis.foot_of(x);
  const Eigen::Vector3d arm = x - foot;
  return solve_cosine(normal.dot(arm), normal.dot(axis.direction.cross(arm)),
                      height - normal.dot(foot), slack);
}

/// The turns of a direction v about a unit vector after which `normal . v = cosine`.
inline Turns turn_direction(const Eigen::Vector3d& direction, const Eigen::Vector3d& v,
                            const Eigen::Vector3d& normal, double cosine, double slack) {
  const double along = direction.dot(v) * normal.dot(direction);
  return solve_cosine(normal.dot(v) - along, normal.dot(direction.cross(v)), cosine - along, slack);
}

/// A turn about a first and a second axis: the second is carried along by the first.
struct TwoTurns {
  Turn first, second;
};

/// Up to two of them.
struct TurnPairs {
  std::array<TwoTurns, 2> values{};
  int count = 0;

  const TwoTurns* begin() const { return values.data(); }
  const TwoTurns* end() const { return values.data() + count; }
};

/// Turns about two axes through one point that bring x to y, both as seen from that point.
inline TurnPairs turn_about_meeting(const Eigen::Vector3d& first, const Eigen::Vector3d& second,
                                    const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                                    double slack) {
  const double cosine = first.dot(second);
  const double sine_squared = 1 - cosine * cosine;
  if (sine_squared < kSingular * kSingular)  // one axis twice
    return {{TwoTurns{{}, turn_towards(second, x, y)}}, 1};
  // z, between the two turns, is on the cones about both axes.
  const double along_first = first.dot(y);
  const double along_second = second.dot(x);
  const double a = (along_first - cosine * along_second) / sine_squared;
  const double b = (along_second - cosine * along_first) / sine_squared;
  const Eigen::Vector3d middle = a * first + b * second;
  const double squared = x.squaredNorm() - middle.squaredNorm();
  if (squared < -slack * x.squaredNorm() - kDouble)  // beside the centre nothing is exact
    return {};
  if (squared <= kDouble * x.squaredNorm())
    return {{TwoTurns{turn_towards(first, middle, y), turn_towards(second, x, middle)}}, 1};
  const Eigen::Vector3d off = std::sqrt(squared / sine_squared) * first.cross(second);
  TurnPairs pairs;
  for (const Eigen::Vector3d& z : {Eigen::Vector3d(middle + off), Eigen::Vector3d(middle - off)})
    pairs.values[static_cast<std::size_t>(pairs.count++)] = {turn_towards(first, z, y),
                                                             turn_towards(second, x, z)};
  return pairs;
}

/// Turns about two parallel axes that bring x to y, as far as the plane across them goes.
inline TurnPairs turn_about_parallel(const Axis& first, const Axis& second,
                                     const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                                     double slack) {
  const Eigen::Vector3d wanted = y - first.foot_of(y);
  const Eigen::Vector3d foot = second.foot_of(x);
  const Eigen::Vector3d arm = x - foot;
  const Eigen::Vector3d off = foot - first.foot_of(foot);
  const Eigen::Vector3d aside = second.direction.cross(arm);
  const Turns seconds =
      solve_cosine(2 * off.dot(arm), 2 * off.dot(aside),
                   wanted.squaredNorm() - off.squaredNorm() - arm.squaredNorm(), slack);
  TurnPairs pairs;
  for (const Turn& turn : seconds) {
    const Eigen::Vector3d between = off + turn.cosine * arm + turn.sine * aside;
    pairs.values[static_cast<std::size_t>(pairs.count++)] = {
        turn_towards(first.direction, between, wanted), turn};
  }
  return pairs;
}

}  // namespace kinship::inverse
