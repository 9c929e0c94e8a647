#include "robots/inverse/six_joints.hpp"

#include <numbers>

#include "robots/inverse/subproblems.hpp"

namespace kinship::inverse {
namespace {

constexpr int kFreeTurns = 8;  // of a joint that a pose leaves free, until the others can follow
constexpr double kSmallestSineSquared = 1e-12;  // of lines whose meeting point can be told
constexpr Turn kFreeStep{std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2};  // a turn in as many

/// A way in which three joints place a point.
struct Placement {
  std::array<Turn, 3> turns;
};

/// Up to four of them.
struct Placements {
  std::array<Placement, 4> values;
  int count = 0;

  void add(const TwoTurns& first_two, const Turn& third) {
    values[static_cast<std::size_t>(count++)] = {{first_two.first, first_two.second, third}};
  }
  const Placement* begin() const { return values.data(); }
  const Placement* end() const { return values.data() + count; }
};

/// Where two lines meet. The values of locked joints between them may have moved it.
Eigen::Vector3d meeting_point(const Axis& a, const Axis& b) {
  const Eigen::Vector3d normal = a.direction.cross(b.direction);
  const double squared = normal.squaredNorm();
  if (squared < kSmallestSineSquared)
    return a.point;
  const double along = (b.point - a.point).cross(b.direction).dot(normal) / squared;
  return a.point + along * a.direction;
}

/// Turns about three axes that bring x to y; the first two meet or are parallel.
Placements place(const std::array<const Axis*, 3>& axes, const Eigen::Vector3d& x,
                 const Eigen::Vector3d& y, bool meet, double slack) {
  const Axis& first = *axes[0];
  const Axis& second = *axes[1];
  const Axis& third = *axes[2];
  Placements placements;
  if (meet) {
    const Eigen::Vector3d centre = meeting_point(first, second);
    const Eigen::Vector3d to_y = y - centre;
    for (const Turn& turn : turn_to_distance(third, x, centre, to_y.squaredNorm(), slack)) {
      const Eigen::Vector3d to_x = turned(third, turn, x) - centre;
      for (const TwoTurns& two :
           turn_about_meeting(first.direction, second.direction, to_x, to_y, slack))
        placements.add(two, turn);
    }
    return placements;
  }
  const Eigen::Vector3d& normal = first.direction;
  for (const Turn& turn : turn_to_height(third, x, normal, normal.dot(y), slack))
    for (const TwoTurns& two : turn_about_parallel(first, second, turned(third, turn, x), y, slack))
      placements.add(two, turn);
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
    auto& turns = placements.values[static_cast<std::size_t>(i)].turns;
    turns = {turns[2].back(), turns[1].back(), turns[0].back()};
  }
  return placements;
}

/// Notes a branch that is left out. \return whether the joint may turn so.
bool allowed(const TurnWindow& window, const Turn& turn, SixJointBranches& branches) {
  const bool holds = window.holds(turn);
  branches.outside = branches.outside || !holds;
  return holds;
}

void solve_wrist(const SixJointTask& task, PointRule rule, SixJointBranches& branches) {
  const std::array<Axis, 6>& axes = task.axes;
  const Eigen::Vector3d& h4 = axes[3].direction;
  const Eigen::Vector3d& h5 = axes[4].direction;
  const Eigen::Vector3d& h6 = axes[5].direction;
  const Eigen::Vector3d& wrist = axes[5].point;
  const Eigen::Vector3d side = h6.unitOrthogonal();
  const Eigen::Vector3d h6_turned = task.wanted.R * h6;
  const Eigen::Vector3d side_turned = task.wanted.R * side;
  for (const Placement& placement : place(axes, wrist, task.wanted(wrist), rule, task.slack)) {
    const std::array<Turn, 3>& turns = placement.turns;
    if (!allowed(task.windows[0], turns[0], branches) ||
        !allowed(task.windows[1], turns[1], branches) ||
        !allowed(task.windows[2], turns[2], branches))
      continue;
    // The wrist's part of the pose, seen where the first three axes stand at 0.
    const auto seen = [&](const Eigen::Vector3d& v) {
      return turned(axes[2].direction, turns[2].back(),
                    turned(axes[1].direction, turns[1].back(),
                           turned(axes[0].direction, turns[0].back(), v)));
    };
    const Eigen::Vector3d h6_wanted = seen(h6_turned);
    const Eigen::Vector3d side_wanted = seen(side_turned);
    const std::array<double, 3> q = {turns[0].angle(), turns[1].angle(), turns[2].angle()};
    for (const Turn& fifth : turn_direction(h5, h6, h4, h4.dot(h6_wanted), task.slack)) {
      if (!allowed(task.windows[4], fifth, branches))
        continue;
      const Turn fourth = turn_towards(h4, turned(h5, fifth, h6), h6_wanted);
      if (!allowed(task.windows[3], fourth, branches))
        continue;
      const Eigen::Vector3d side_left =
          turned(h5, fifth.back(), turned(h4, fourth.back(), side_wanted));
      const Turn sixth = turn_towards(h6, side, side_left);
      if (allowed(task.windows[5], sixth, branches))
        branches.add({q[0], q[1], q[2], fourth.angle(), fifth.angle(), sixth.angle()});
    }
  }
}

/// The three parallel joints of a chain whose other joints are set.
/// \param rest  their part of the pose: a displacement in their plane.
/// \return whether they can do it, within limits or not.
bool solve_parallel(const SixJointTask& task, const Displacement& rest, std::array<double, 6> q,
                    SixJointBranches& branches) {
  const std::array<Axis, 6>& axes = task.axes;
  const Eigen::Vector3d& h = axes[1].direction;
  const Eigen::Vector3d side = h.unitOrthogonal();
  const Turn all = turn_towards(h, side, rest.R * side);
  const auto along = [&](const Axis& axis, const Turn& turn) {
    return axis.direction.dot(h) > 0 ? turn : turn.back();
  };
  const TurnPairs pairs =
      turn_about_parallel(axes[1], axes[2], axes[3].point, rest(axes[3].point), task.slack);
  for (const TwoTurns& pair : pairs) {
    const Turn last = along(axes[3], all * pair.first.back() * along(axes[2], pair.second).back());
    if (!allowed(task.windows[1], pair.first, branches) ||
        !allowed(task.windows[2], pair.second, branches) ||
        !allowed(task.windows[3], last, branches))
      continue;
    q[1] = pair.first.angle();
    q[2] = pair.second.angle();
    q[3] = last.angle();
    branches.add(q);
  }
  return pairs.count > 0;
}

/// The part of a pose's solution that comes before three parallel axes.
struct BeforeParallel {
  double q1, q5;
  Displacement left;    ///< of the pose, without joint 1: joints 2 to 6
  Displacement beyond;  ///< joint 5, turned back
};

/// The last joint, and then the parallel ones.
void solve_last(const SixJointTask& task, const BeforeParallel& before,
                SixJointBranches& branches) {
  const Eigen::Vector3d& h = task.axes[1].direction;
  const Axis& axis = task.axes[5];
  const Eigen::Vector3d h_seen = before.left.R.transpose() * h;  // from the tip, behind joint 6
  const Eigen::Vector3d h_before = before.beyond.R * h;
  // Axis 6 parallel to the others: as far as directions go, any turn would do.
  const bool free = h_before.cross(axis.direction).squaredNorm() < kDouble;
  Turn sixth = turn_towards(axis.direction, h_seen, h_before);
  for (int k = 0; k < (free ? kFreeTurns : 1); ++k, sixth = sixth * kFreeStep) {
    if (!allowed(task.windows[5], sixth, branches))
      continue;
    const Displacement rest = before.left * (displacement(axis, sixth.back()) * before.beyond);
    if (solve_parallel(task, rest, {before.q1, 0, 0, 0, before.q5, sixth.angle()}, branches))
      return;
  }
}

/// Axes 2, 3, 4 are parallel, 5 and 6 meet. Turns about the parallel axes change no component along
/// them. Joints 5 and 6 leave the point where their axes meet: its component gives q1. Joint 6
/// leaves the direction of its axis: the component of that direction, turned by joint 5, gives q5.
/// The direction of the parallel axes as seen from the tip gives q6, and what is left is a planar
/// arm.
void solve_three_parallel(const SixJointTask& task, SixJointBranches& branches) {
  const std::array<Axis, 6>& axes = task.axes;
  const Eigen::Vector3d& h = axes[1].direction;
  const Eigen::Vector3d& h6 = axes[5].direction;
  const Eigen::Vector3d& meeting = axes[5].point;
  const Axis back{-axes[0].direction, axes[0].point, false};
  for (const Turn& first :
       turn_to_height(back, task.wanted(meeting), h, h.dot(meeting), task.slack)) {
    if (!allowed(task.windows[0], first, branches))
      continue;
    const Displacement left = displacement(axes[0], first.back()) * task.wanted;
    const double cosine = h.dot(left.R * h6);
    for (const Turn& fifth : turn_direction(axes[4].direction, h6, h, cosine, task.slack))
      if (allowed(task.windows[4], fifth, branches))
        solve_last(task, {first.angle(), fifth.angle(), left, displacement(axes[4], fifth.back())},
                   branches);
  }
}

/// The same task for the chain read from tip to base.
SixJointTask reversed(const SixJointTask& task) {
  SixJointTask way_back;
  for (std::size_t i = 0; i < 6; ++i) {
    way_back.axes[i] = task.axes[5 - i];
    way_back.windows[i] = task.windows[5 - i].back();
  }
  way_back.wanted = task.wanted.inverse();
  way_back.slack = task.slack;
  return way_back;
}

SixJointBranches solve_forward(const SixJointTask& task, const SixJointRule& rule) {
  SixJointBranches branches;
  if (rule.kind == SixJointRule::Kind::SphericalWrist)
    solve_wrist(task, rule.point, branches);
  else
    solve_three_parallel(task, branches);
  return branches;
}

}  // namespace

SixJointBranches solve_six_joints(const SixJointTask& task, const SixJointRule& rule) {
  if (!rule.reversed)
    return solve_forward(task, rule);
  SixJointBranches branches = solve_forward(reversed(task), rule);
  for (int i = 0; i < branches.count; ++i) {
    std::array<double, 6>& q = branches.angles[static_cast<std::size_t>(i)];
    q = {-q[5], -q[4], -q[3], -q[2], -q[1], -q[0]};
  }
  return branches;
}

}  // namespace kinship::inverse
