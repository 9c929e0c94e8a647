// The kernel that moves postures, for the instruction set that the including unit is compiled for.

#include "robots/inverse/simd_step_kernel.hpp"

namespace kinship::inverse {
namespace {

constexpr double kPoseWeight = 10;        // of the pose against the marks
constexpr double kPullDamping = 0.02;     // m per joint unit
constexpr double kLargestPullStep = 0.3;  // of one joint, joint units
constexpr int kMarkRows = 3 * kLaneMarks;
constexpr int kPullRows = kMarkRows + 6;

/// Derivative of the marks and the pose by one joint; m, the pose times kPoseWeight.
struct WidePullColumn {
  Wide rows[kPullRows];
};

/// Index in the lower half of a symmetric matrix, row by row.
KINSHIP_SIMD_INLINE constexpr int at(int row, int column) { return row * (row + 1) / 2 + column; }

/// Positions of the marks: on the line from a joint to the next one, or to the transfer frame.
KINSHIP_SIMD_INLINE void place(const LaneChain& chain, const LaneMarks& marks,
                               const WideColumn* columns, const WideFrame& frame,
                               Wide (&p)[kMarkRows]) {
  for (int mark = 0; mark < kLaneMarks; ++mark) {
    const int joint = marks.joint[mark];
    const Wide* from = columns[joint].rows;
    const Wide* to = joint + 1 < chain.dof ? columns[joint + 1].rows : frame.p;
    for (int i = 0; i < 3; ++i)
      p[3 * mark + i] = from[i] + marks.share[mark] * (to[i] - from[i]);
  }
}

/// Velocity of a point by a turning joint, m.
KINSHIP_SIMD_INLINE void velocity(const WideColumn& joint, const Wide* p, double scale, Wide* v) {
  const Wide x = joint.rows[3], y = joint.rows[4], z = joint.rows[5];
  const Wide a = p[0] - joint.rows[0], b = p[1] - joint.rows[1], c = p[2] - joint.rows[2];
  v[0] = scale * (y * c - z * b);
  v[1] = scale * (z * a - x * c);
  v[2] = scale * (x * b - y * a);
}

KINSHIP_SIMD_INLINE WidePullColumn pull_column(const LaneChain& chain, const LaneMarks& marks,
                                               int j, const WideColumn& joint,
                                               const Wide (&p)[kMarkRows], const WideFrame& frame) {
  WidePullColumn column;
  for (int mark = 0; mark < kLaneMarks; ++mark) {
    Wide* v = column.rows + 3 * mark;
    if (j <= marks.joint[mark])
      velocity(joint, p + 3 * mark, chain.length_m, v);
    else
      v[0] = v[1] = v[2] = Wide{};
  }
  Wide pose[7];
  velocity(joint, frame.p, kPoseWeight * chain.length_m, pose);
  for (int i = 0; i < 3; ++i)
    pose[3 + i] = kPoseWeight * joint.rows[3 + i];
  pose[6] = Wide{};
  for (int i = 0; i < 6; ++i)
    column.rows[kMarkRows + i] = pose[chain.row_of[i]];
  return column;
}

/// Solves a symmetric system of `size` rows, given by its lower half, by L D L^T in place.
KINSHIP_SIMD_INLINE void solve(int size, Wide* system, Wide* wanted) {
  for (int c = 0; c < size; ++c) {
    const Wide inverse = 1.0 / system[at(c, c)];
    for (int r = c + 1; r < size; ++r) {
      const Wide factor = system[at(r, c)] * inverse;
      for (int i = r; i < size; ++i)
        system[at(i, r)] -= factor * system[at(i, c)];
      wanted[r] -= factor * wanted[c];
    }
    for (int r = c + 1; r < size; ++r)
      system[at(r, c)] *= inverse;
    wanted[c] *= inverse;
  }
  for (int r = size - 1; r > 0; --r)
    for (int c = 0; c < r; ++c)
      wanted[c] -= system[at(r, c)] * wanted[r];
}

void pull_from(const LaneChain& chain, const LaneMarks& marks, int lane, LanePull& pull) {
  Wide q[kLaneJoints], p[kMarkRows], off[kMarkRows];
  Wide system[kLaneJoints * (kLaneJoints + 1) / 2], step[kLaneJoints];
  WideColumn joints[kLaneJoints];
  WidePullColumn columns[kLaneJoints];
  for (int j = 0; j < chain.dof; ++j)
    q[j] = load(pull.q[j] + lane);
  const WideFrame frame = forward(chain, q, joints);
  place(chain, marks, joints, frame, p);
  Wide squared = Wide{};
  for (int i = 0; i < kMarkRows; ++i) {
    off[i] = load(pull.wanted[i] + lane) - chain.length_m * p[i];
    squared += off[i] * off[i];
  }
  store(pull.distance_m + lane, root(squared));
  for (int j = 0; j < chain.dof; ++j) {
    columns[j] = pull_column(chain, marks, j, joints[j], p, frame);
    step[j] = Wide{};
    for (int i = 0; i < kMarkRows; ++i)
      step[j] += columns[j].rows[i] * off[i];
    for (int k = 0; k <= j; ++k) {
      Wide sum = Wide{};
#pragma GCC unroll 18
      for (int i = 0; i < kPullRows; ++i)
        sum += columns[j].rows[i] * columns[k].rows[i];
      system[at(j, k)] = k == j ? sum + kPullDamping * kPullDamping : sum;
    }
  }
  solve(chain.dof, system, step);
  for (int j = 0; j < chain.dof; ++j)
    store(pull.q[j] + lane, q[j] + clamped(step[j], all(-kLargestPullStep), all(kLargestPullStep)));
}

void pull(const LaneChain& chain, const LaneMarks& marks, LanePull& pull) {
  for (int lane = 0; lane < kLanes; lane += KINSHIP_SIMD_WIDTH)
    pull_from(chain, marks, lane, pull);
}

}  // namespace
}  // namespace kinship::inverse
