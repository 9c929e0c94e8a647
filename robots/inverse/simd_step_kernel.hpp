// The kernels, for the instruction set that the including unit is compiled for.
#pragma once

#include "robots/inverse/simd_vector.hpp"

namespace kinship::inverse {
namespace {

constexpr double kDampingShare = 0.05;  // of the squared error
constexpr double kSmallestDamping = 1e-7;
constexpr double kLargestStep = 1.0;   // rad, or the chain's length
constexpr double kSteeringGain = 0.5;  // share of the way to mid-range per iteration

/// Linear velocity, angular velocity and a row of zeros for task axes that do not matter.
struct WideColumn {
  Wide rows[7];
};

/// Moves on to the frame of the next joint.
KINSHIP_SIMD_INLINE void follow(const LaneJoint& joint, WideFrame& frame) {
  const double c = joint.tilt_cosine, s = joint.tilt_sine;
#pragma GCC unroll 3
  for (int row = 0; row < 3; ++row) {
    const Wide x = frame.R[3 * row], y = frame.R[3 * row + 1], z = frame.R[3 * row + 2];
    frame.p[row] += x * joint.p[0] + y * joint.p[1] + z * joint.p[2];
    frame.R[3 * row + 1] = c * y + s * z;
    frame.R[3 * row + 2] = c * z - s * y;
  }
}

/// Pose of the last joint; columns receive each joint's position and axis for now.
KINSHIP_SIMD_INLINE WideFrame forward(const LaneChain& chain, const Wide* q, WideColumn* columns) {
  WideTurns turns;
  for (int j = 0; j < chain.dof; ++j)
    sine_cosine(chain.joints[j].slides ? all(chain.joints[j].twist) : q[j], turns.sine[j],
                turns.cosine[j]);
  WideFrame frame = frame_of(chain.R_first, chain.p_first);
  for (int j = 0; j < chain.dof; ++j) {
    const LaneJoint& joint = chain.joints[j];
    if (j > 0)
      follow(joint, frame);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      columns[j].rows[i] = frame.p[i];
      columns[j].rows[3 + i] = frame.R[3 * i + 2];
    }
    columns[j].rows[6] = Wide{};
    turn(turns.sine[j], turns.cosine[j], frame);
    if (!joint.slides)
      continue;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      frame.p[i] += q[j] * frame.R[3 * i + 2];
  }
  follow(chain.R_last, chain.p_last, frame);
  return frame;
}

/// Makes a column of the Jacobian of a joint's origin and axis.
KINSHIP_SIMD_INLINE void differentiate(bool slides, const Wide (&p)[3], WideColumn& column) {
  const Wide x = column.rows[3], y = column.rows[4], z = column.rows[5];
  if (slides) {
    for (int i = 0; i < 3; ++i) {
      column.rows[i] = column.rows[3 + i];
      column.rows[3 + i] = Wide{};
    }
    return;
  }
  const Wide a = p[0] - column.rows[0], b = p[1] - column.rows[1], c = p[2] - column.rows[2];
  column.rows[0] = y * c - z * b;
  column.rows[1] = z * a - x * c;
  column.rows[2] = x * b - y * a;
}

/// Pull of a joint towards mid-range: 0 within its limits.
KINSHIP_SIMD_INLINE Wide pull_of(const LaneJoint& joint, Wide q, Wide& outside) {
  if (!joint.bounded)
    return Wide{};
  Wide off_middle = q - joint.middle;
  if (!joint.slides)
    off_middle = wrapped(off_middle);
  const WideMask pulled = absolute(off_middle) > joint.half;
  outside = pulled ? all(1) : outside;
  return pulled ? -kSteeringGain * off_middle : Wide{};
}

/// Leaves out the joints at a limit that the error pushes across.
template <int kRows>
KINSHIP_SIMD_INLINE void hold(const LaneJoint& joint, Wide q, const Wide (&error)[kRows],
                              const int* row_of, WideColumn& column) {
  if (!joint.bounded)
    return;
  Wide push = Wide{};
  for (int row = 0; row < kRows; ++row)
    push += column.rows[row_of[row]] * error[row];
  const WideMask stopped = ((push < 0.0) & (q <= joint.middle - joint.half)) |
                           ((push > 0.0) & (q >= joint.middle + joint.half));
  for (int row = 0; row < 6; ++row)
    column.rows[row] = stopped ? Wide{} : column.rows[row];
}

/// Solves a symmetric system, given by its lower half, by L D L^T: in `wanted` the answer replaces
/// the right side, in `system` the factors replace the matrix. Column by column both ways: the
/// steps wait for each other, not the operations of one step.
template <int kRows>
KINSHIP_SIMD_INLINE void solve(Wide (&system)[kRows][kRows], Wide (&wanted)[kRows]) {
#pragma GCC unroll 6
  for (int c = 0; c < kRows; ++c) {
    const Wide inverse = 1.0 / system[c][c];
    const Wide scaled = wanted[c] * inverse;
    Wide below[kRows];
#pragma GCC unroll 6
    for (int r = c + 1; r < kRows; ++r) {
      below[r] = system[r][c];
      system[r][c] *= inverse;
    }
#pragma GCC unroll 6
    for (int r = c + 1; r < kRows; ++r) {
      wanted[r] -= system[r][c] * wanted[c];
#pragma GCC unroll 6
      for (int i = r; i < kRows; ++i)
        system[i][r] -= system[i][c] * below[r];
    }
    wanted[c] = scaled;
  }
#pragma GCC unroll 6
  for (int r = kRows - 1; r > 0; --r)
#pragma GCC unroll 6
    for (int c = 0; c < r; ++c)
      wanted[c] -= system[r][c] * wanted[r];
}

/// State of one iteration. kRows: of the task; row_of maps them to those of a column.
template <int kRows>
struct WideIteration {
  WideIteration(const LaneChain& of, LaneLimits with, const int* rows)
      : chain(of), limits(with), row_of(rows) {}  // the rest is written before it is read

  const LaneChain& chain;
  const LaneLimits limits;
  const int* row_of;
  Wide q[kLaneJoints], pull[kLaneJoints];
  WideColumn columns[kLaneJoints];
  Wide error[kRows], system[kRows][kRows], wanted[kRows];
  Wide squared, outside;
};

/// Error of the task, and the frame of the last joint.
template <int kRows>
KINSHIP_SIMD_INLINE WideFrame evaluate(const Wide (&target)[12], WideIteration<kRows>& now) {
  const WideFrame frame = forward(now.chain, now.q, now.columns);
  Wide full[7];
  task_error(target, frame, reinterpret_cast<Wide(&)[6]>(full));
  full[6] = Wide{};
  now.squared = Wide{};
#pragma GCC unroll 6
  for (int row = 0; row < kRows; ++row) {
    now.error[row] = full[now.row_of[row]];
    now.squared += now.error[row] * now.error[row];
  }
  return frame;
}

/// J J^T, damped, and the right side.
template <int kRows>
KINSHIP_SIMD_INLINE void linearize(const WideFrame& frame, WideIteration<kRows>& now) {
#pragma GCC unroll 6
  for (int r = 0; r < kRows; ++r) {
    now.wanted[r] = now.error[r];
#pragma GCC unroll 6
    for (int c = 0; c <= r; ++c)
      now.system[r][c] = Wide{};
  }
  now.outside = Wide{};
  for (int j = 0; j < now.chain.dof; ++j) {
    const LaneJoint& joint = now.chain.joints[j];
    differentiate(joint.slides, frame.p, now.columns[j]);
    if (now.limits == LaneLimits::Hold)
      hold(joint, now.q[j], now.error, now.row_of, now.columns[j]);
    Wide column[kRows];
#pragma GCC unroll 6
    for (int r = 0; r < kRows; ++r)
      column[r] = now.columns[j].rows[now.row_of[r]];
#pragma GCC unroll 6
    for (int r = 0; r < kRows; ++r)
#pragma GCC unroll 6
      for (int c = 0; c <= r; ++c)
        now.system[r][c] += column[r] * column[c];
    if (now.limits != LaneLimits::Steer)
      continue;
    now.pull[j] = pull_of(joint, now.q[j], now.outside);
#pragma GCC unroll 6
    for (int r = 0; r < kRows; ++r)
      now.wanted[r] -= now.pull[j] * column[r];  // the pull may use only what the task leaves free
  }
#pragma GCC unroll 6
  for (int r = 0; r < kRows; ++r)
    now.system[r][r] += kDampingShare * now.squared + kSmallestDamping;
}

/// One step on with the solution in `wanted`. \return the squared length of the step.
template <int kRows>
KINSHIP_SIMD_INLINE Wide advance(WideIteration<kRows>& now) {
  Wide moved = Wide{};
  for (int j = 0; j < now.chain.dof; ++j) {
    const LaneJoint& joint = now.chain.joints[j];
    Wide step = now.limits == LaneLimits::Steer ? now.pull[j] : Wide{};
#pragma GCC unroll 6
    for (int r = 0; r < kRows; ++r)
      step += now.columns[j].rows[now.row_of[r]] * now.wanted[r];
    step = clamped(step, all(-kLargestStep), all(kLargestStep));
    Wide next = now.q[j] + step;
    if (now.limits == LaneLimits::Hold && joint.bounded)
      next = clamped(next, all(joint.middle - joint.half), all(joint.middle + joint.half));
    moved += (next - now.q[j]) * (next - now.q[j]);
    now.q[j] = next;
  }
  return moved;
}

/// One iteration of the lanes from `lane` on. kMapped: not every task axis matters.
template <int kRows, bool kMapped>
KINSHIP_SIMD_INLINE void step_from(const LaneChain& chain, LaneLimits limits, int lane,
                                   LaneBatch& batch) {
  static constexpr int kAllRows[6] = {0, 1, 2, 3, 4, 5};
  WideIteration<kRows> now(chain, limits, kMapped ? chain.row_of : kAllRows);
  Wide target[12];
  for (int i = 0; i < 12; ++i)
    target[i] = load(batch.target[i] + lane);
  for (int j = 0; j < chain.dof; ++j)
    now.q[j] = load(batch.q[j] + lane);
  linearize(evaluate(target, now), now);
  solve<kRows>(now.system, now.wanted);
  store(batch.moved + lane, advance(now));
  for (int j = 0; j < chain.dof; ++j)
    store(batch.q[j] + lane, now.q[j]);
  store(batch.squared + lane, now.squared);
  store(batch.outside + lane, now.outside);
}

void step(const LaneChain& chain, LaneLimits limits, LaneBatch& batch) {
  for (int lane = 0; lane < kLanes; lane += KINSHIP_SIMD_WIDTH) {
    if (chain.rows == 6)
      step_from<6, false>(chain, limits, lane, batch);
    else if (chain.rows > 3)
      step_from<6, true>(chain, limits, lane, batch);
    else
      step_from<3, true>(chain, limits, lane, batch);
  }
}

/// Turned about any axis. Source: Rodrigues' formula; Siciliano et al., Robotics (2009), eq. 2.25.
KINSHIP_SIMD_INLINE void turn_about(const double (&axis)[3], Wide s, Wide c, WideFrame& frame) {
  const Wide v = 1.0 - c;
  const double x = axis[0], y = axis[1], z = axis[2];
  const Wide R[9] = {x * x * v + c,     x * y * v - z * s, x * z * v + y * s,
                     x * y * v + z * s, y * y * v + c,     y * z * v - x * s,
                     x * z * v - y * s, y * z * v + x * s, z * z * v + c};
#pragma GCC unroll 3
  for (int row = 0; row < 3; ++row) {
    const Wide a = frame.R[3 * row], b = frame.R[3 * row + 1], d = frame.R[3 * row + 2];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      frame.R[3 * row + i] = a * R[i] + b * R[3 + i] + d * R[6 + i];
  }
}

void check(const LaneArm& arm, LaneCheck& check) {
  for (int lane = 0; lane < kLanes; lane += KINSHIP_SIMD_WIDTH) {
    WideTurns turns;
    for (int j = 0; j < arm.dof; ++j)
      sine_cosine(load(check.q[j] + lane), turns.sine[j], turns.cosine[j]);
    WideFrame frame = frame_of(arm.joints[0].R, arm.joints[0].p);
    for (int j = 0; j < arm.dof; ++j) {
      const LaneArm::Joint& joint = arm.joints[j];
      if (j > 0)
        follow(joint.R, joint.p, frame);
      if (!joint.slides) {
        turn_about(joint.axis, turns.sine[j], turns.cosine[j], frame);
        continue;
      }
      const Wide q = load(check.q[j] + lane);
      for (int i = 0; i < 3; ++i)
        frame.p[i] += q * (frame.R[3 * i] * joint.axis[0] + frame.R[3 * i + 1] * joint.axis[1] +
                           frame.R[3 * i + 2] * joint.axis[2]);
    }
    follow(arm.R_last, arm.p_last, frame);
    Wide target[12], error[6];
    for (int i = 0; i < 12; ++i)
      target[i] = load(check.target[i] + lane);
    task_error(target, frame, error);
    Wide distance = Wide{}, angle = Wide{};
    for (int i = 0; i < 3; ++i) {
      distance += arm.matters[i] * error[i] * error[i];
      angle += arm.matters[3 + i] * error[3 + i] * error[3 + i];
    }
    store(check.distance_m + lane, root(distance));
    store(check.angle_rad + lane, root(angle));
  }
}

}  // namespace
}  // namespace kinship::inverse
