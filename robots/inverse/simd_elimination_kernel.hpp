// The kernel that finds all branches of an arm of six turning joints, for the instruction set that
// the including unit is compiled for.
//
// Source: M. Raghavan and B. Roth, Inverse kinematics of the general 6R manipulator and related
// linkages, Journal of Mechanical Design 115 (1993): joint 6 leaves the last axis where it is, and
// fourteen functions of that axis (of its direction l and a point p on it: l, p, p.p, p.l, p x l
// and (p.p) l - 2 (p.l) p) are linear in sine and cosine of each joint. Seen from axis 2, six of
// them do not depend on joint 2 and the others turn with it, as four pairs: that separates the
// elimination of joints 1 and 2 into four real equations and a complex one. Half angles instead of
// their tangents and reflections instead of pivots: no angle is a special one.
#pragma once

#include "robots/inverse/simd_resultant_kernel.hpp"
#include "robots/inverse/simd_step_kernel.hpp"

namespace kinship::inverse {
namespace {

constexpr int kStill = 6;  // invariants that a turn about z leaves alone; the other eight are pairs
constexpr int kPairs = 4;  // x and y of l, p, p x l, (p.p) l - 2 (p.l) p

struct Complex {
  double real, imaginary;
};

KINSHIP_SIMD_INLINE Complex product(Complex a, Complex b) {
  return {a.real * b.real - a.imaginary * b.imaginary, a.real * b.imaginary + a.imaginary * b.real};
}

KINSHIP_SIMD_INLINE Complex difference(Complex a, Complex b) {
  return {a.real - b.real, a.imaginary - b.imaginary};
}

/// The invariants of an axis of direction l through p, z components first. T: double or Wide.
template <typename T>
KINSHIP_SIMD_INLINE void invariants(const T (&l)[3], const T (&p)[3], T* result) {
  const T pp = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
  const T pl = p[0] * l[0] + p[1] * l[1] + p[2] * l[2];
  result[0] = l[2];
  result[1] = p[2];
  result[2] = pp;
  result[3] = pl;
  result[4] = p[0] * l[1] - p[1] * l[0];
  result[5] = pp * l[2] - 2.0 * pl * p[2];
  for (int i = 0; i < 2; ++i) {
    result[6 + i] = l[i];
    result[8 + i] = p[i];
    result[12 + i] = pp * l[i] - 2.0 * pl * p[i];
  }
  result[10] = p[1] * l[2] - p[2] * l[1];
  result[11] = p[2] * l[0] - p[0] * l[2];
}

/// The wanted pose, without the constant frames at the arm's ends.
struct WantedFrame {
  double R[9], p[3];
};

KINSHIP_SIMD_INLINE WantedFrame wanted_frame(const LaneChain& chain, const double (&target)[12]) {
  WantedFrame wanted;
  double R[9], p[3];
  for (int i = 0; i < 3; ++i) {  // times the inverse of the last frame
    p[i] = target[9 + i] - chain.p_first[i];
    for (int j = 0; j < 3; ++j)
      R[3 * i + j] = target[3 * i] * chain.R_last[3 * j] +
                     target[3 * i + 1] * chain.R_last[3 * j + 1] +
                     target[3 * i + 2] * chain.R_last[3 * j + 2];
    for (int j = 0; j < 3; ++j)
      p[i] -= R[3 * i + j] * chain.p_last[j];
  }
  const double* F = chain.R_first;
  for (int i = 0; i < 3; ++i) {  // the inverse of the first frame times that
    wanted.p[i] = F[i] * p[0] + F[3 + i] * p[1] + F[6 + i] * p[2];
    for (int j = 0; j < 3; ++j)
      wanted.R[3 * i + j] = F[i] * R[j] + F[3 + i] * R[3 + j] + F[6 + i] * R[6 + j];
  }
  return wanted;
}

/// The invariants of the wanted last axis, seen from axis 2 with joint 2 at 0: sums of 1, cos and
/// sin of joint 1.
struct WantedAxis {
  double one[LaneElimination::kInvariants], cosine[LaneElimination::kInvariants],
      sine[LaneElimination::kInvariants];
};

/// A vector of the base seen from axis 2, after the turn of joint 1, before that of joint 2. T:
/// double or Wide.
template <typename T>
KINSHIP_SIMD_INLINE void tilt_back(const LaneJoint& second, const T (&v)[3], T (&result)[3]) {
  result[0] = v[0];
  result[1] = second.tilt_cosine * v[1] + second.tilt_sine * v[2];
  result[2] = second.tilt_cosine * v[2] - second.tilt_sine * v[1];
}

KINSHIP_SIMD_INLINE void invariants_at(const LaneJoint& second, const WantedFrame& wanted, double s,
                                       double c, double* result) {
  const double* p = second.p;
  const double l1[3] = {c * wanted.R[2] + s * wanted.R[5], c * wanted.R[5] - s * wanted.R[2],
                        wanted.R[8]};
  const double p1[3] = {c * wanted.p[0] + s * wanted.p[1] - p[0],
                        c * wanted.p[1] - s * wanted.p[0] - p[1], wanted.p[2] - p[2]};
  double l2[3], p2[3];
  tilt_back(second, l1, l2);
  tilt_back(second, p1, p2);
  invariants(l2, p2, result);
}

KINSHIP_SIMD_INLINE WantedAxis wanted_axis(const LaneJoint& second, const WantedFrame& wanted) {
  double at_0[LaneElimination::kInvariants], at_half[LaneElimination::kInvariants],
      at_quarter[LaneElimination::kInvariants];
  invariants_at(second, wanted, 0, 1, at_0);
  invariants_at(second, wanted, 0, -1, at_half);
  invariants_at(second, wanted, 1, 0, at_quarter);
  WantedAxis axis;
  for (int i = 0; i < LaneElimination::kInvariants; ++i) {
    axis.one[i] = 0.5 * (at_0[i] + at_half[i]);
    axis.cosine[i] = 0.5 * (at_0[i] - at_half[i]);
    axis.sine[i] = at_quarter[i] - axis.one[i];
  }
  return axis;
}

/// The complement of the two columns of joint 1, and the rows that solve for them.
struct StillElimination {
  double free[kPairs][kStill];  ///< rows; orthonormal, orthogonal to both columns
  double solve[2][kStill];      ///< rows; give cosine and sine of joint 1
};

/// Rows times the reflection that brings the vector v, from `first` on, to one entry.
/// \return that entry.
KINSHIP_SIMD_INLINE double reflect_rows(double (&v)[kStill], int first,
                                        double (&rows)[kStill][kStill]) {
  double squared = kTiniest;
  for (int i = first; i < kStill; ++i)
    squared += v[i] * v[i];
  const double length = __builtin_sqrt(squared);
  const double left = v[first] < 0 ? length : -length;
  v[first] -= left;
  const double scale = -1.0 / (left * v[first]);
  for (int r = 0; r < kStill; ++r) {
    double sum = 0;
    for (int i = first; i < kStill; ++i)
      sum += rows[r][i] * v[i];
    for (int i = first; i < kStill; ++i)
      rows[r][i] -= scale * sum * v[i];
  }
  return left;
}

KINSHIP_SIMD_INLINE StillElimination still_elimination(const WantedAxis& wanted) {
  double Q[kStill][kStill] = {}, a[kStill], b[kStill];
  for (int i = 0; i < kStill; ++i) {
    Q[i][i] = 1;
    a[i] = wanted.cosine[i];
  }
  const double aa = reflect_rows(a, 0, Q);
  double ab = 0;
  for (int i = 0; i < kStill; ++i) {
    b[i] = 0;
    for (int r = 0; r < kStill; ++r)
      b[i] += Q[r][i] * wanted.sine[r];
  }
  ab = b[0];
  const double bb = reflect_rows(b, 1, Q);
  StillElimination result;
  for (int i = 0; i < kStill; ++i) {
    for (int k = 0; k < kPairs; ++k)
      result.free[k][i] = Q[i][2 + k];
    result.solve[1][i] = Q[i][1] / bb;
    result.solve[0][i] = (Q[i][0] - ab * result.solve[1][i]) / aa;
  }
  return result;
}

/// The complex row that is 0 on the three columns of joint 1 in the pairs.
KINSHIP_SIMD_INLINE void turning_elimination(const WantedAxis& wanted, Complex (&row)[kPairs]) {
  Complex a[kPairs], b[kPairs], c[kPairs];
  for (int k = 0; k < kPairs; ++k) {
    a[k] = {wanted.one[kStill + 2 * k], wanted.one[kStill + 2 * k + 1]};
    b[k] = {wanted.cosine[kStill + 2 * k], wanted.cosine[kStill + 2 * k + 1]};
    c[k] = {wanted.sine[kStill + 2 * k], wanted.sine[kStill + 2 * k + 1]};
  }
  double squared = kTiniest;
  for (int k = 0; k < kPairs; ++k) {  // cofactors
    const int i = k == 0 ? 1 : 0, j = k <= 1 ? 2 : 1, m = k <= 2 ? 3 : 2;
    const auto minor = [&](int r, int s) {
      return difference(product(b[r], c[s]), product(b[s], c[r]));
    };
    const Complex x = product(a[i], minor(j, m)), y = product(a[j], minor(i, m)),
                  z = product(a[m], minor(i, j));
    const double sign = k % 2 == 0 ? 1 : -1;
    row[k] = {sign * (x.real - y.real + z.real), sign * (x.imaginary - y.imaginary + z.imaginary)};
    squared += row[k].real * row[k].real + row[k].imaginary * row[k].imaginary;
  }
  const double scale = 1 / __builtin_sqrt(squared);
  for (Complex& value : row)
    value = {scale * value.real, scale * value.imaginary};
}

/// Six equations without joints 1 and 2.
KINSHIP_SIMD_INLINE void eliminate_two(const LaneElimination& arm, const WantedAxis& wanted,
                                       const StillElimination& still, SixEquations& equations) {
  Complex row[kPairs];
  turning_elimination(wanted, row);
  for (int first = 0; first < LaneElimination::kPadded; first += KINSHIP_SIMD_WIDTH) {
    for (int k = 0; k < kPairs; ++k) {
      Wide sum{};
      for (int i = 0; i < kStill; ++i)
        sum += still.free[k][i] * load(arm.terms[i] + first);
      store(equations.terms[k] + first, sum);
    }
    Wide real{}, imaginary{};
    for (int k = 0; k < kPairs; ++k) {
      const Wide x = load(arm.terms[kStill + 2 * k] + first);
      const Wide y = load(arm.terms[kStill + 2 * k + 1] + first);
      real += row[k].real * x - row[k].imaginary * y;
      imaginary += row[k].imaginary * x + row[k].real * y;
    }
    store(equations.terms[kPairs] + first, real);
    store(equations.terms[kPairs + 1] + first, imaginary);
  }
  for (int k = 0; k < kPairs; ++k) {
    double constant = 0;
    for (int i = 0; i < kStill; ++i)
      constant += still.free[k][i] * wanted.one[i];
    equations.terms[k][0] -= constant;           // times sin^2 of half of joint 4,
    equations.terms[k][2 * kBlock] -= constant;  // and cos^2
  }
}

/// Joints 4 and 5 from the triangle of the resultant where it is 0.
KINSHIP_SIMD_INLINE void joints_4_5(const Wide (&left)[kEquations][kEquations], Wide* q) {
  Wide v[kEquations];
  v[5] = all(1);
#pragma GCC unroll 5
  for (int r = 4; r >= 0; --r) {
    Wide sum{};
#pragma GCC unroll 5
    for (int c = r + 1; c < kEquations; ++c)
      sum += left[r][c] * v[c];
    v[r] = -sum / left[r][r];
  }
  const Wide a = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  const Wide b = v[3] * v[3] + v[4] * v[4] + v[5] * v[5];
  const Wide m = v[0] * v[3] + v[1] * v[4] + v[2] * v[5];
  q[3] = angle_of(2.0 * m, b - a);
  const WideMask last = b > a;
  const Wide one = last ? v[3] : v[0];
  const Wide c = last ? v[4] : v[1], s = last ? v[5] : v[2];
  q[4] = angle_of(one < 0.0 ? -s : s, one < 0.0 ? -c : c);
}

/// Joints 1, 2 and 6 from the others, by forward kinematics from axis 2 to axis 6.
KINSHIP_SIMD_INLINE void joints_1_2_6(const LaneChain& chain, const WantedFrame& frame,
                                      const WantedAxis& wanted, const StillElimination& still,
                                      Wide* q) {
  WideTurns turns;
  for (int j = 2; j < 5; ++j)
    sine_cosine(q[j], turns.sine[j], turns.cosine[j]);
  constexpr double kUnit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, kOrigin[3] = {};
  WideFrame end = frame_of(kUnit, kOrigin);
  for (int j = 2; j < 6; ++j) {
    follow(chain.joints[j], end);
    if (j < 5)
      turn(turns.sine[j], turns.cosine[j], end);
  }
  const Wide l[3] = {end.R[2], end.R[5], end.R[8]};
  Wide seen[LaneElimination::kInvariants];
  invariants(l, end.p, seen);
  Wide c{}, s{};
  for (int i = 0; i < kStill; ++i) {
    c += still.solve[0][i] * (seen[i] - wanted.one[i]);
    s += still.solve[1][i] * (seen[i] - wanted.one[i]);
  }
  q[0] = angle_of(s, c);
  Wide scale = 1.0 / root(c * c + s * s + kTiniest);
  c *= scale;
  s *= scale;
  Wide c2{}, s2{};
  for (int i = kStill; i < kStill + kPairs; i += 2) {  // direction and point
    const Wide x = wanted.one[i] + c * wanted.cosine[i] + s * wanted.sine[i];
    const Wide y = wanted.one[i + 1] + c * wanted.cosine[i + 1] + s * wanted.sine[i + 1];
    c2 += x * seen[i] + y * seen[i + 1];
    s2 += y * seen[i] - x * seen[i + 1];
  }
  q[1] = angle_of(s2, c2);
  scale = 1.0 / root(c2 * c2 + s2 * s2 + kTiniest);
  c2 *= scale;
  s2 *= scale;
  const Wide x1[3] = {c * frame.R[0] + s * frame.R[3], c * frame.R[3] - s * frame.R[0],
                      all(frame.R[6])};
  Wide x2[3];
  tilt_back(chain.joints[1], x1, x2);
  const Wide x = c2 * x2[0] + s2 * x2[1], y = c2 * x2[1] - s2 * x2[0], z = x2[2];
  q[5] = angle_of(end.R[1] * x + end.R[4] * y + end.R[7] * z,
                  end.R[0] * x + end.R[3] * y + end.R[6] * z);
}

void eliminate(const LaneChain& chain, const LaneElimination& arm, const LaneHarmonics& harmonics,
               const double (&target)[12], LaneBranches& branches) {
  const WantedFrame frame = wanted_frame(chain, target);
  const WantedAxis wanted = wanted_axis(chain.joints[1], frame);
  const StillElimination still = still_elimination(wanted);
  SixEquations equations;
  eliminate_two(arm, wanted, still, equations);
  Zeros zeros;
  zeros_of(equations, harmonics, zeros);
  branches.count = zeros.count;
  for (int first = 0; first < zeros.count; first += KINSHIP_SIMD_WIDTH) {
    Wide q[kEquations], left[kEquations][kEquations];
    q[2] = load(zeros.at + first);
    Wide sine, cosine;
    sine_cosine(q[2], sine, cosine);
    resultant(equations, cosine, sine, left);
    joints_4_5(left, q);
    joints_1_2_6(chain, frame, wanted, still, q);
    for (int j = 0; j < kEquations; ++j)
      store(branches.q[j] + first, q[j]);
  }
}

}  // namespace
}  // namespace kinship::inverse
