// Spherical wrists at many values of the locked joints, for the instruction set that the including
// unit is compiled for. The steps are those of six_joints.cpp and subproblems.hpp, whose sources
// hold; what is singular in a lane is left to them.
#pragma once

#include "robots/inverse/simd_vector.hpp"

namespace kinship::inverse {
namespace {

constexpr double kLaneSingular = 1e-7;      // a shorter direction is left to the scalar form
constexpr double kLaneDouble = 1e-13;       // two turns closer than its root as well,
constexpr double kLaneUndefined = 1e-28;    // and a turn about a direction that is that close
constexpr double kLaneMeetSquared = 1e-12;  // sine of two axes whose meeting point can be told

struct Wide3 {
  Wide x, y, z;
};

KINSHIP_SIMD_INLINE Wide3 operator+(const Wide3& a, const Wide3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
KINSHIP_SIMD_INLINE Wide3 operator-(const Wide3& a, const Wide3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
KINSHIP_SIMD_INLINE Wide3 operator*(Wide a, const Wide3& b) { return {a * b.x, a * b.y, a * b.z}; }
KINSHIP_SIMD_INLINE Wide dot(const Wide3& a, const Wide3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
KINSHIP_SIMD_INLINE Wide3 cross(const Wide3& a, const Wide3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
KINSHIP_SIMD_INLINE Wide3 everywhere(const double* v) { return {all(v[0]), all(v[1]), all(v[2])}; }

struct WideTurn {
  Wide cosine, sine;

  KINSHIP_SIMD_INLINE WideTurn back() const { return {cosine, -sine}; }
};

KINSHIP_SIMD_INLINE WideTurn operator*(const WideTurn& a, const WideTurn& b) {
  return {a.cosine * b.cosine - a.sine * b.sine, a.sine * b.cosine + a.cosine * b.sine};
}

struct WideAxis {
  Wide3 direction, point;
};

/// The lanes that still have a branch, those that the scalar form has to do, and those where a
/// limit cut a branch off.
struct WideState {
  WideMask hard, outside;
  double slack;  ///< of LaneWrist
};

/// Turns of a cosine; see solve_cosine.
struct WideTurnPair {
  WideTurn turns[2];
  WideMask valid;
};

KINSHIP_SIMD_INLINE WideTurnPair solve_cosine(Wide a, Wide b, Wide c, WideMask alive,
                                              WideState& state) {
  const Wide amplitude = root(a * a + b * b);
  const Wide inverse = 1.0 / amplitude;
  const WideTurn middle{a * inverse, b * inverse};
  const Wide cosine = c * inverse;
  const Wide sine_squared = (1.0 - cosine) * (1.0 + cosine);
  const WideMask two = sine_squared > kLaneDouble;
  state.hard |= alive & ((amplitude < kLaneSingular) |
                         (~two & (absolute(cosine) <= 1 + state.slack + kLaneDouble)));
  const WideTurn half{cosine, root(two ? sine_squared : all(1))};
  return {{middle * half, middle * half.back()}, alive & two};
}

/// See turn_towards.
KINSHIP_SIMD_INLINE WideTurn turn_towards(const Wide3& direction, const Wide3& from,
                                          const Wide3& to, WideMask alive, WideState& state) {
  const Wide3 from_across = from - dot(direction, from) * direction;
  const Wide3 to_across = to - dot(direction, to) * direction;
  const Wide cosine = dot(from_across, to_across);
  const Wide sine = dot(direction, cross(from_across, to_across));
  const Wide squared = cosine * cosine + sine * sine;
  const WideMask undefined = squared <= kLaneUndefined * dot(from, from) * dot(to, to);
  state.hard |= alive & undefined;
  const Wide scale = 1.0 / root(undefined ? all(1) : squared);
  return {cosine * scale, sine * scale};
}

/// A vector turned about a unit vector.
KINSHIP_SIMD_INLINE Wide3 turned(const Wide3& direction, const WideTurn& turn, const Wide3& v) {
  return turn.cosine * v + turn.sine * cross(direction, v) +
         ((1.0 - turn.cosine) * dot(direction, v)) * direction;
}

KINSHIP_SIMD_INLINE WideMask allowed(const LaneWrist::Window& window, const WideTurn& turn,
                                     WideMask alive, WideState& state) {
  const WideMask holds =
      turn.cosine * window.cosine_middle + turn.sine * window.sine_middle >= window.cosine_half;
  state.outside |= alive & ~holds;
  return alive & holds;
}

/// frame * (the displacement of a joint)
KINSHIP_SIMD_INLINE void displace(const LaneWrist::Axis& axis, Wide value, WideFrame& frame) {
  const Wide3 d = everywhere(axis.direction), p = everywhere(axis.point);
  if (axis.slides) {
#pragma GCC unroll 3
    for (int row = 0; row < 3; ++row)
      frame.p[row] += value * (frame.R[3 * row] * d.x + frame.R[3 * row + 1] * d.y +
                               frame.R[3 * row + 2] * d.z);
    return;
  }
  WideTurn turn;
  sine_cosine(value, turn.sine, turn.cosine);
#pragma GCC unroll 3
  for (int row = 0; row < 3; ++row) {  // rows of R, turned back about the axis
    const Wide3 r{frame.R[3 * row], frame.R[3 * row + 1], frame.R[3 * row + 2]};
    const Wide3 t = turned(d, turn.back(), r);
    frame.p[row] += dot(r, p) - dot(t, p);
    frame.R[3 * row] = t.x;
    frame.R[3 * row + 1] = t.y;
    frame.R[3 * row + 2] = t.z;
  }
}

KINSHIP_SIMD_INLINE Wide3 rotated(const WideFrame& frame, const Wide3& v) {
  return {frame.R[0] * v.x + frame.R[1] * v.y + frame.R[2] * v.z,
          frame.R[3] * v.x + frame.R[4] * v.y + frame.R[5] * v.z,
          frame.R[6] * v.x + frame.R[7] * v.y + frame.R[8] * v.z};
}

KINSHIP_SIMD_INLINE Wide3 rotated_back(const WideFrame& frame, const Wide3& v) {
  return {frame.R[0] * v.x + frame.R[3] * v.y + frame.R[6] * v.z,
          frame.R[1] * v.x + frame.R[4] * v.y + frame.R[7] * v.z,
          frame.R[2] * v.x + frame.R[5] * v.y + frame.R[8] * v.z};
}

KINSHIP_SIMD_INLINE Wide3 moved(const WideFrame& frame, const Wide3& x) {
  return rotated(frame, x) + Wide3{frame.p[0], frame.p[1], frame.p[2]};
}

/// Six joints with a wrist, the others locked.
struct WideWrist {
  WideAxis axes[6];
  Wide3 side;                      ///< across the last axis
  Wide3 axis_turned, side_turned;  ///< the last axis and `side`, as the pose wants them
  Wide3 wrist_moved;               ///< the wrist, as the pose wants it
};

/// Whichever are fewer: the axes before the locks are carried back, or those behind them along.
KINSHIP_SIMD_INLINE void lock(const LaneWrist& arm, const double* wanted,
                              const double (&locked)[kLaneLocks][kLanes], int lane,
                              WideWrist& wrist) {
  static constexpr double kIdentity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, kZero[3] = {};
  WideFrame by = frame_of(kIdentity, kZero);
  wrist.side = everywhere(arm.side);
  int lock = arm.carries_on ? 0 : arm.locks - 1, free = arm.carries_on ? 0 : 5;
  bool any = false;
  for (int i = 0; i < arm.count; ++i) {
    const LaneWrist::Axis& axis = arm.axes[arm.carries_on ? i : arm.count - 1 - i];
    if (axis.locked) {
      const Wide value = load(locked[lock] + lane);
      displace(axis, arm.carries_on ? value : -value, by);
      lock += arm.carries_on ? 1 : -1;
      any = true;
      continue;
    }
    WideAxis& to = wrist.axes[free];
    to = {everywhere(axis.direction), everywhere(axis.point)};
    if (any)
      to = {rotated(by, to.direction), moved(by, to.point)};
    if (any && free == 5)
      wrist.side = rotated(by, wrist.side);
    free += arm.carries_on ? 1 : -1;
  }
  const WideFrame T = frame_of(wanted, wanted + 9);
  const Wide3 &axis = wrist.axes[5].direction, &point = wrist.axes[5].point;
  if (arm.carries_on) {
    const Wide3 off{by.p[0], by.p[1], by.p[2]};
    wrist.axis_turned = rotated(T, rotated_back(by, axis));
    wrist.side_turned = rotated(T, rotated_back(by, wrist.side));
    wrist.wrist_moved = moved(T, rotated_back(by, point - off));
  } else {
    wrist.axis_turned = rotated(by, rotated(T, axis));
    wrist.side_turned = rotated(by, rotated(T, wrist.side));
    wrist.wrist_moved = moved(by, moved(T, point));
  }
}

/// The first three joints bring the wrist to its place, in up to four ways.
struct WidePlacements {
  WideTurn turns[4][3];
  WideMask valid[4];
};

/// The second turn about two axes through `centre`, and the first; see turn_about_meeting.
struct WideMeeting {
  Wide3 first, second, normal;  ///< their directions, and the cross product of them
  Wide cosine, sine_squared;

  struct Turns {
    WideTurn firsts[2], seconds[2];
    WideMask valid;
  };

  KINSHIP_SIMD_INLINE Turns turn(const Wide3& x, const Wide3& y, WideMask alive,
                                 WideState& state) const {
    const Wide along_first = dot(first, y), along_second = dot(second, x);
    const Wide inverse = 1.0 / sine_squared;
    const Wide3 middle = ((along_first - cosine * along_second) * inverse) * first +
                         ((along_second - cosine * along_first) * inverse) * second;
    const Wide length = dot(x, x);
    const Wide squared = length - dot(middle, middle);
    const WideMask two = squared > kLaneDouble * length;
    state.hard |= alive & ~two & (squared >= -state.slack * length - kLaneDouble);
    Turns turns;
    turns.valid = alive & two;
    const Wide3 off = root((two ? squared : all(0)) * inverse) * normal;
    for (int i = 0; i < 2; ++i) {
      const Wide3 z = i == 0 ? middle + off : middle - off;
      turns.firsts[i] = turn_towards(first, z, y, turns.valid, state);
      turns.seconds[i] = turn_towards(second, x, z, turns.valid, state);
    }
    return turns;
  }
};

/// Turns about three axes, the first two of which meet, that bring x to y.
KINSHIP_SIMD_INLINE WidePlacements place(const WideAxis& first, const WideAxis& second,
                                         const WideAxis& third, const Wide3& x, const Wide3& y,
                                         WideState& state) {
  const Wide3 normal = cross(first.direction, second.direction);
  const Wide sine_squared = dot(normal, normal);
  const WideMask meet = sine_squared > kLaneMeetSquared;
  state.hard |= ~meet;
  const Wide along =
      dot(cross(second.point - first.point, second.direction), normal) / sine_squared;
  const Wide3 centre = first.point + along * first.direction;
  const Wide3 to_y = y - centre;
  const Wide3 foot = third.point + dot(third.direction, x - third.point) * third.direction;
  const Wide3 arm = x - foot, off = foot - centre, aside = cross(third.direction, arm);
  const WideTurnPair thirds =
      solve_cosine(2.0 * dot(off, arm), 2.0 * dot(off, aside),
                   dot(to_y, to_y) - dot(off, off) - dot(arm, arm), meet, state);
  const WideMeeting meeting{first.direction, second.direction, normal,
                            dot(first.direction, second.direction), sine_squared};
  WidePlacements placements;
  for (int i = 0; i < 2; ++i) {
    const WideTurn& turn = thirds.turns[i];
    const WideMeeting::Turns met =
        meeting.turn(off + turn.cosine * arm + turn.sine * aside, to_y, thirds.valid, state);
    for (int k = 0; k < 2; ++k) {
      WideTurn(&turns)[3] = placements.turns[2 * i + k];
      turns[0] = met.firsts[k];
      turns[1] = met.seconds[k];
      turns[2] = turn;
      placements.valid[2 * i + k] = met.valid;
    }
  }
  return placements;
}

/// The branches of some lanes before their angles: cosines and sines by joint, branch and lane.
struct alignas(64) LaneTurns {
  static constexpr int kSlots = 8;
  double cosine[kSlots][6][kLanes], sine[kSlots][6][kLanes];
  unsigned valid[kSlots];  ///< lanes, as bits

  KINSHIP_SIMD_INLINE void keep(int slot, int joint, int lane, const WideTurn& turn) {
    store(cosine[slot][joint] + lane, turn.cosine);
    store(sine[slot][joint] + lane, turn.sine);
  }
};

/// The lanes from `lane` on.
struct WideTask {
  const LaneWrist& arm;
  const WideWrist& wrist;
  int lane;
};

/// The last three joints, whose axes meet, after a placement of the wrist.
KINSHIP_SIMD_INLINE void turn_wrist(const WideTask& task, const WideTurn (&turns)[3],
                                    WideMask alive, int placement, WideState& state,
                                    LaneTurns& found) {
  const LaneWrist& arm = task.arm;
  const WideWrist& wrist = task.wrist;
  const int lane = task.lane;
  const Wide3 &h4 = wrist.axes[3].direction, &h5 = wrist.axes[4].direction,
              &h6 = wrist.axes[5].direction;
  Wide3 axis_wanted = wrist.axis_turned, side_wanted = wrist.side_turned;
  for (int j = 0; j < 3; ++j) {
    axis_wanted = turned(wrist.axes[j].direction, turns[j].back(), axis_wanted);
    side_wanted = turned(wrist.axes[j].direction, turns[j].back(), side_wanted);
  }
  const Wide along = dot(h5, h6) * dot(h4, h5);
  const WideTurnPair fifths = solve_cosine(dot(h4, h6) - along, dot(h4, cross(h5, h6)),
                                           dot(h4, axis_wanted) - along, alive, state);
  for (int i = 0; i < 2; ++i) {
    const int slot = 2 * placement + i;
    const WideTurn& fifth = fifths.turns[i];
    WideMask valid = allowed(arm.windows[4], fifth, fifths.valid, state);
    const WideTurn fourth = turn_towards(h4, turned(h5, fifth, h6), axis_wanted, valid, state);
    valid = allowed(arm.windows[3], fourth, valid, state);
    if (bits(valid) == 0)
      continue;
    const Wide3 left = turned(h5, fifth.back(), turned(h4, fourth.back(), side_wanted));
    const WideTurn sixth = turn_towards(h6, wrist.side, left, valid, state);
    valid = allowed(arm.windows[5], sixth, valid, state);
    found.valid[slot] |= bits(valid) << lane;
    for (int j = 0; j < 3; ++j)
      found.keep(slot, j, lane, turns[j]);
    found.keep(slot, 3, lane, fourth);
    found.keep(slot, 4, lane, fifth);
    found.keep(slot, 5, lane, sixth);
  }
}

/// All branches.
KINSHIP_SIMD_INLINE void solve_wrist(const WideTask& task, WideState& state, LaneTurns& found) {
  const LaneWrist& arm = task.arm;
  const WideWrist& wrist = task.wrist;
  const WideAxis* axes = wrist.axes;
  const Wide3& point = axes[5].point;
  const WidePlacements placements =
      arm.last_meet ? place(axes[2], axes[1], axes[0], wrist.wrist_moved, point, state)
                    : place(axes[0], axes[1], axes[2], point, wrist.wrist_moved, state);
  for (int i = 0; i < 4; ++i) {
    WideTurn turns[3];
    for (int j = 0; j < 3; ++j)
      turns[j] = arm.last_meet ? placements.turns[i][2 - j].back() : placements.turns[i][j];
    WideMask alive = placements.valid[i];
    for (int j = 0; j < 3; ++j)
      alive = allowed(arm.windows[j], turns[j], alive, state);
    if (bits(alive) != 0)
      turn_wrist(task, turns, alive, i, state, found);
  }
}

/// One branch after the other, of one lane after the other, as angles.
/// \param done  lanes that were solved.
/// \return the number of lanes up to the one that reached `most` branches.
KINSHIP_SIMD_INLINE int gather(const LaneTurns& found, int done, int most,
                               LaneWristBranches& branches) {
  double cosine[6][LaneWristBranches::kCapacity], sine[6][LaneWristBranches::kCapacity];
  int lane = 0;
  for (; lane < done && branches.count < most; ++lane)
    for (int slot = 0; slot < LaneTurns::kSlots; ++slot) {
      if ((found.valid[slot] >> lane & 1U) == 0)
        continue;
      for (int j = 0; j < 6; ++j) {
        cosine[j][branches.count] = found.cosine[slot][j][lane];
        sine[j][branches.count] = found.sine[slot][j][lane];
      }
      branches.lane[branches.count++] = lane;
    }
  for (int i = branches.count; i % KINSHIP_SIMD_WIDTH != 0; ++i)
    for (int j = 0; j < 6; ++j) {
      cosine[j][i] = 1;
      sine[j][i] = 0;
    }
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < branches.count; i += KINSHIP_SIMD_WIDTH)
      store(branches.angles[j] + i, exact_angle_of(load(sine[j] + i), load(cosine[j] + i)));
  return lane;
}

void wrist(const LaneWrist& arm, const double (&wanted)[12],
           const double (&locked)[kLaneLocks][kLanes], int most, LaneWristBranches& branches) {
  LaneTurns found;
  for (unsigned& valid : found.valid)
    valid = 0;
  unsigned hard = 0, outside = 0;
  int done = 0;
  for (int count = 0; done < kLanes && count < most; done += KINSHIP_SIMD_WIDTH) {
    WideWrist wide{};
    lock(arm, wanted, locked, done, wide);
    WideState state{{}, {}, arm.slack};
    solve_wrist({arm, wide, done}, state, found);
    hard |= bits(state.hard) << done;
    outside |= bits(state.outside) << done;
    count = 0;
    for (unsigned& valid : found.valid) {
      valid &= ~hard;
      count += __builtin_popcount(valid);
    }
  }
  branches.count = 0;
  const unsigned lanes = (1U << gather(found, done, most, branches)) - 1;
  branches.hard = hard & lanes;
  branches.outside = outside & lanes;
}

}  // namespace
}  // namespace kinship::inverse
