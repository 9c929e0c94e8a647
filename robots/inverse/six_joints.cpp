#include "robots/inverse/six_joints.hpp"

#include <numbers>

#include "robots/inverse/subproblems.hpp"

namespace kinship::inverse {
namespace {

constexpr int kFreeTurns = 8;  // of a joint that a pose leaves free, until the others can follow

/// Up to four ways in which three joints place a point.
struct Placements {
  std::array<std::array<double, 3>, 4> angles;
  int count = 0;

  void add(double first, double second, double third) {
    if (count < 4)
      angles[static_cast<std::size_t>(count++)] = {first, second, third};
  }
};

/// Turns about three axes that bring x to y; the first two meet in their points or are parallel.
Placements place(const std::array<const Axis*, 3>& axes, const Eigen::Vector3d& x,
                 const Eigen::Vector3d& y, bool meet, double slack) {
  const Axis& first = *axes[0];
  const Axis& second = *axes[1];
  const Axis& third = *axes[2];
  Placements placements;
  if (meet) {
    const Eigen::Vector3d& centre = first.point;
    const Eigen::Vector3d to_y = y - centre;
    for (const double c : turn_to_distance(third, x, centre, to_y.squaredNorm(), slack)) {
      const Eigen::Vector3d to_x = turned(third, c, x) - centre;
      for (const TwoAngles ab :
           turn_about_meeting(first.direction, second.direction, to_x, to_y, slack))
        placements.add(ab.first, ab.second, c);
    }
    return placements;
  }
  const Eigen::Vector3d& normal = first.direction;
  for (const double c : turn_to_height(third, x, normal, normal.dot(y), slack))
    for (const TwoAngles ab : turn_about_parallel(first, second, turned(third, c, x), y, slack))
      placements.add(ab.first, ab.second, c);
  return placements;
}

/// The same by any rule: the last two axes are the first two of the way back.
Placements place(const std::array<Axis, 6>& axes, const Eigen::Vector3d& x,
                 const Eigen::Vector3d& y, PointRule rule, double slack) {
  const bool meet = rule == PointRule::FirstMeet || rule == PointRule::LastMeet;
  if (rule == PointRule::FirstMeet || rule == PointRule::FirstParallel)
    return place({&axes[0], &axes[1], &axes[2]}, x, y, meet, slack);
  Placements placements = place({&axes[2], &axes[1], &axes[0]}, y, x, meet, slack);
  for (int i = 0; i < placements.count; ++i) {
    auto& angles = placements.angles[static_cast<std::size_t>(i)];
    angles = {-angles[2], -angles[1], -angles[0]};
  }
  return placements;
}

/// Any unit vector across another.
Eigen::Vector3d across(const Eigen::Vector3d& direction) { return direction.unitOrthogonal(); }

void solve_wrist(const std::array<Axis, 6>& axes, const Displacement& wanted, PointRule rule,
                 double slack, SixJointBranches& branches) {
  const Eigen::Vector3d& h4 = axes[3].direction;
  const Eigen::Vector3d& h5 = axes[4].direction;
  const Eigen::Vector3d& h6 = axes[5].direction;
  const Eigen::Vector3d& wrist = axes[5].point;
  const Eigen::Vector3d side = across(h6);
  const Placements placements = place(axes, wrist, wanted(wrist), rule, slack);
  for (int i = 0; i < placements.count; ++i) {
    const auto& [q1, q2, q3] = placements.angles[static_cast<std::size_t>(i)];
    // What is left for the wrist to do, seen where the first three axes stand at 0.
    const auto back = [&](const Eigen::Vector3d& v) {
      return turned(axes[2].direction, -q3,
                    turned(axes[1].direction, -q2, turned(axes[0].direction, -q1, v)));
    };
    const Eigen::Vector3d h6_wanted = back(wanted.R * h6);
    const Eigen::Vector3d side_wanted = back(wanted.R * side);
    for (const double q5 : turn_direction(h5, h6, h4, h4.dot(h6_wanted), slack)) {
      const double q4 = angle_about(h4, turned(h5, q5, h6), h6_wanted);
      const Eigen::Vector3d side_left = turned(h5, -q5, turned(h4, -q4, side_wanted));
      branches.add({q1, q2, q3, q4, q5, angle_about(h6, side, side_left)});
    }
  }
}

/// The three parallel joints of a chain whose other joints are set.
/// \return whether they can do what is left: `rest`, a displacement in their plane.
bool solve_parallel(const std::array<Axis, 6>& axes, const Displacement& rest, double slack,
                    std::array<double, 6> q, SixJointBranches& branches) {
  const Eigen::Vector3d& h = axes[1].direction;
  const Eigen::Vector3d side = across(h);
  const double turn = angle_about(h, side, rest.R * side);
  const auto sign = [&](const Axis& axis) { return axis.direction.dot(h) > 0 ? 1.0 : -1.0; };
  const TwoAnglePairs pairs =
      turn_about_parallel(axes[1], axes[2], axes[3].point, rest(axes[3].point), slack);
  for (const TwoAngles pair : pairs) {
    q[1] = pair.first;
    q[2] = pair.second;
    q[3] = sign(axes[3]) * std::remainder(turn - q[1] - sign(axes[2]) * q[2], 2 * std::numbers::pi);
    branches.add(q);
  }
  return pairs.count > 0;
}

/// The parallel axes' direction keeps what it has of axis 5's point and direction: that gives q1,
/// then q5. What they do to it as seen from axis 6 gives q6, the rest is a planar arm.
void solve_three_parallel(const std::array<Axis, 6>& axes, const Displacement& wanted, double slack,
                          SixJointBranches& branches) {
  const Eigen::Vector3d& h = axes[1].direction;
  const Eigen::Vector3d& h5 = axes[4].direction;
  const Eigen::Vector3d& h6 = axes[5].direction;
  const Eigen::Vector3d& meeting = axes[5].point;
  const Axis back{-axes[0].direction, axes[0].point, false};
  for (const double q1 : turn_to_height(back, wanted(meeting), h, h.dot(meeting), slack)) {
    const Displacement left = axes[0].at(-q1) * wanted;
    const Eigen::Vector3d h_seen = left.R.transpose() * h;  // from axis 6, after its turn
    for (const double q5 : turn_direction(h5, h6, h, h6.dot(h_seen), slack)) {
      const Eigen::Vector3d h_before = turned(h5, -q5, h);
      // axis 6 parallel to the others: any q6 would do for the directions
      const bool free = h_before.cross(h6).squaredNorm() < kDouble;
      const double q6 = angle_about(h6, h_seen, h_before);
      for (int k = 0; k < (free ? kFreeTurns : 1); ++k) {
        const double turn = q6 + 2 * std::numbers::pi * k / kFreeTurns;
        const Displacement rest = left * axes[5].at(-turn) * axes[4].at(-q5);
        if (solve_parallel(axes, rest, slack, {q1, 0, 0, 0, q5, turn}, branches))
          break;
      }
    }
  }
}

}  // namespace

SixJointBranches solve_six_joints(const std::array<Axis, 6>& axes, const Displacement& wanted,
                                  const SixJointRule& rule, double slack) {
  SixJointBranches branches;
  const std::array<Axis, 6> way_back =
      rule.reversed ? std::array{axes[5], axes[4], axes[3], axes[2], axes[1], axes[0]} : axes;
  const Displacement there = rule.reversed ? wanted.inverse() : wanted;
  if (rule.kind == SixJointRule::Kind::SphericalWrist)
    solve_wrist(way_back, there, rule.point, slack, branches);
  else
    solve_three_parallel(way_back, there, slack, branches);
  if (rule.reversed)
    for (int i = 0; i < branches.count; ++i) {
      std::array<double, 6>& q = branches.angles[static_cast<std::size_t>(i)];
      q = {-q[5], -q[4], -q[3], -q[2], -q[1], -q[0]};
    }
  return branches;
}

}  // namespace kinship::inverse
