// The resultant that arms of six turning joints are solved with, for the instruction set that the
// including unit is compiled for.
#pragma once

#include "robots/inverse/simd_vector.hpp"

namespace kinship::inverse {
namespace {

constexpr int kEquations = 6;
constexpr int kBlock = 3;  // 1, cos and sin of joint 5
constexpr int kPerTurnTerm = 9;
constexpr double kTiniest = 1e-300;  // keeps a division by a column of zeros finite

/// Six equations in joints 3, 4 and 5: sums over the terms of LaneElimination.
struct SixEquations {
  double terms[kEquations][LaneElimination::kPadded];
};

/// Reflects rows so that only the first has a nonzero entry in `column`; applies it to the later
/// columns too. \return that entry.
/// Source: A. Householder, Journal of the ACM 5 (1958).
template <int kRows>
KINSHIP_SIMD_INLINE Wide reflect(Wide* const (&rows)[kRows], int column, int columns) {
  Wide squared = all(kTiniest);
#pragma GCC unroll 6
  for (int i = 0; i < kRows; ++i)
    squared += rows[i][column] * rows[i][column];
  const Wide length = root(squared);
  const Wide left = rows[0][column] < 0.0 ? length : -length;
  const Wide first = rows[0][column] - left;
  const Wide scale = -1.0 / (left * first);
#pragma GCC unroll 9
  for (int c = column + 1; c < columns; ++c) {
    Wide sum = first * rows[0][c];
#pragma GCC unroll 6
    for (int i = 1; i < kRows; ++i)
      sum += rows[i][column] * rows[i][c];
    sum *= scale;
    rows[0][c] -= sum * first;
#pragma GCC unroll 6
    for (int i = 1; i < kRows; ++i)
      rows[i][c] -= sum * rows[i][column];
  }
  rows[0][column] = left;
  return left;
}

/// The equations at an angle of joint 3, times the sine and times the cosine of half of joint 4:
/// twelve linear equations in sin^3, sin^2 cos, sin cos^2 and cos^3 of that half, each times 1, cos
/// and sin of joint 5. Reflections bring them to a triangle; the first six unknowns are eliminated
/// block by block, since both halves are the same equations.
/// \param left  the triangle of the last six unknowns, of sin cos^2 and cos^3; undefined below it.
/// \return the determinant, but for a factor that is the same at every angle.
Wide resultant(const SixEquations& equations, Wide cosine, Wide sine,
               Wide (&left)[kEquations][kEquations]) {
  Wide upper[kEquations][3 * kBlock], lower[kEquations][3 * kBlock];
  for (int r = 0; r < kEquations; ++r) {
    const double* terms = equations.terms[r];
    for (int c = 0; c < kPerTurnTerm; ++c)
      upper[r][c] =
          terms[c] + cosine * terms[kPerTurnTerm + c] + sine * terms[2 * kPerTurnTerm + c];
  }
  Wide* const u[] = {upper[0], upper[1], upper[2], upper[3], upper[4], upper[5]};
  Wide first = reflect<6>({u[0], u[1], u[2], u[3], u[4], u[5]}, 0, 9);
  first *= reflect<5>({u[1], u[2], u[3], u[4], u[5]}, 1, 9);
  first *= reflect<4>({u[2], u[3], u[4], u[5]}, 2, 9);

  Wide* const w[] = {lower[0], lower[1], lower[2], lower[3], lower[4], lower[5]};
#pragma GCC unroll 3
  for (int r = 0; r < kBlock; ++r)
#pragma GCC unroll 9
    for (int c = 0; c < 3 * kBlock; ++c) {
      lower[r][c] = upper[r][c];
      lower[kBlock + r][c] = c < 2 * kBlock ? upper[kBlock + r][kBlock + c] : Wide{};
    }
  Wide second = reflect<4>({w[0], w[3], w[4], w[5]}, 0, 9);
  second *= reflect<4>({w[1], w[3], w[4], w[5]}, 1, 9);
  second *= reflect<4>({w[2], w[3], w[4], w[5]}, 2, 9);

#pragma GCC unroll 3
  for (int r = 0; r < kBlock; ++r)
#pragma GCC unroll 6
    for (int c = 0; c < 2 * kBlock; ++c) {
      left[r][c] = lower[kBlock + r][kBlock + c];
      left[kBlock + r][c] = upper[kBlock + r][kBlock + c];
    }
  Wide* const l[] = {left[0], left[1], left[2], left[3], left[4], left[5]};
  Wide third = reflect<6>({l[0], l[1], l[2], l[3], l[4], l[5]}, 0, 6);
  third *= reflect<5>({l[1], l[2], l[3], l[4], l[5]}, 1, 6);
  third *= reflect<4>({l[2], l[3], l[4], l[5]}, 2, 6);
  third *= reflect<3>({l[3], l[4], l[5]}, 3, 6);
  third *= reflect<2>({l[4], l[5]}, 4, 6);
  return first * second * third * left[5][5];
}

/// Sum of harmonics and its derivatives.
struct WideHarmonic {
  Wide value, slope, bend;
};

/// By Horner's rule on the complex unit circle. \param of  LaneHarmonics::kCoefficients.
KINSHIP_SIMD_INLINE WideHarmonic harmonic_at(const double* of, Wide angle) {
  constexpr int kDegree = LaneHarmonics::kDegree;
  Wide sine, cosine;
  sine_cosine(angle, sine, cosine);
  Wide real[3] = {}, imaginary[3] = {};  // of sums of 1, k and k^2 times (a - i b) z^k
#pragma GCC unroll 9
  for (int k = kDegree; k >= 0; --k) {
    const double a = of[k], b = k > 0 ? of[kDegree + k] : 0;
    const double weights[3] = {1, static_cast<double>(k), static_cast<double>(k * k)};
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const Wide next = real[i] * cosine - imaginary[i] * sine + weights[i] * a;
      imaginary[i] = real[i] * sine + imaginary[i] * cosine - weights[i] * b;
      real[i] = next;
    }
  }
  return {real[0], -imaginary[1], -real[2]};
}

/// Angles between bounds, to be refined to zeros of a sum of harmonics, or of its derivative.
struct Zeros {
  static constexpr int kRoom = kLaneBranches + KINSHIP_SIMD_WIDTH;
  int count = 0;
  double at[kRoom], lower[kRoom], upper[kRoom];
  double sign[kRoom];  ///< at the upper bound; opposite at the lower one

  void add(double angle, double from, double to, double sign_at_upper) {
    if (count == kLaneBranches)
      return;
    at[count] = angle;
    lower[count] = from;
    upper[count] = to;
    sign[count++] = sign_at_upper;
  }
};

/// Newton's method between shrinking bounds; a step that would leave them halves them instead.
/// \tparam kOfSlope  for a zero of the derivative.
template <bool kOfSlope>
void refine(const double* coefficients, int steps, Zeros& zeros) {
  for (int i = zeros.count; i % KINSHIP_SIMD_WIDTH != 0; ++i)
    zeros.at[i] = zeros.lower[i] = zeros.upper[i] = zeros.sign[i] = 0;
  for (int first = 0; first < zeros.count; first += KINSHIP_SIMD_WIDTH) {
    Wide angle = load(zeros.at + first);
    Wide lower = load(zeros.lower + first), upper = load(zeros.upper + first);
    const Wide sign = load(zeros.sign + first);
    for (int i = 0; i < steps; ++i) {
      const WideHarmonic now = harmonic_at(coefficients, angle);
      const Wide value = kOfSlope ? now.slope : now.value;
      const WideMask above = value * sign > 0.0;
      upper = above ? angle : upper;
      lower = above ? lower : angle;
      const Wide next = angle - value / (kOfSlope ? now.bend : now.slope);
      const WideMask within = (next >= lower) & (next <= upper);
      angle = within ? next : 0.5 * (lower + upper);
    }
    store(zeros.at + first, angle);
  }
}

/// A sum of harmonics and its derivative at the points of LaneHarmonics: [0] as they are, [1] at
/// the angles with the other sign, with the derivative by that.
struct HarmonicScan {
  double value[2][LaneHarmonics::kPoints], slope[2][LaneHarmonics::kPoints];
};

KINSHIP_SIMD_INLINE void scan(const double* coefficients, const LaneHarmonics& harmonics,
                              HarmonicScan& result) {
  constexpr int kDegree = LaneHarmonics::kDegree;
  for (int first = 0; first < LaneHarmonics::kPoints; first += KINSHIP_SIMD_WIDTH) {
    Wide even = all(coefficients[0]), odd{}, even_slope{}, odd_slope{};
#pragma GCC unroll 8
    for (int k = 1; k <= kDegree; ++k) {
      const Wide cosine = load(harmonics.at_points[k] + first);
      const Wide sine = load(harmonics.at_points[kDegree + k] + first);
      even += coefficients[k] * cosine;
      odd += coefficients[kDegree + k] * sine;
      even_slope -= k * coefficients[k] * sine;
      odd_slope += k * coefficients[kDegree + k] * cosine;
    }
    store(result.value[0] + first, even + odd);
    store(result.value[1] + first, even - odd);
    store(result.slope[0] + first, even_slope + odd_slope);
    store(result.slope[1] + first, even_slope - odd_slope);
  }
}

constexpr double kInterval = kTurnOf / LaneHarmonics::kIntervals;
constexpr int kHalfIntervals = LaneHarmonics::kIntervals / 2;

/// Sorts intervals: into those with a sign change, each with its first guess, and those whose
/// minimum might have two.
KINSHIP_SIMD_INLINE void sort_intervals(const HarmonicScan& scanned, Zeros& crossings,
                                        Zeros& dips) {
  constexpr unsigned kEvery = (1U << KINSHIP_SIMD_WIDTH) - 1;
  constexpr double kShallow = 0.1;  // share of the bend, the square of the interval being 1
  for (int side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1 : -1;
    const double *value = scanned.value[side], *slope = scanned.slope[side];
    const auto add = [&](Zeros& to, int i, double share, double until) {
      const double begin = sign * i * kInterval, end = sign * (i + 1) * kInterval;
      const double at = begin + share * (end - begin);
      side == 0 ? to.add(at, begin, end, until) : to.add(at, end, begin, -until);
    };
    for (int first = 0; first < kHalfIntervals; first += KINSHIP_SIMD_WIDTH) {
      const unsigned from = bits(load(value + first) < 0.0);
      const unsigned to = bits(load(value + first + 1) < 0.0);
      const unsigned down = bits(load(slope + first) < 0.0);
      const unsigned down_after = bits(load(slope + first + 1) < 0.0);
      for (unsigned crossed = from ^ to; crossed != 0; crossed &= crossed - 1) {
        const int i = first + __builtin_ctz(crossed);
        add(crossings, i, value[i] / (value[i] - value[i + 1]), value[i + 1] < 0 ? -1 : 1);
      }
      for (unsigned dip = ~(from ^ to) & (from ^ down) & ~(to ^ down_after) & kEvery; dip != 0;
           dip &= dip - 1) {
        const int i = first + __builtin_ctz(dip);
        const double bend = (slope[i + 1] - slope[i]) * kInterval;
        const double share = slope[i] / (slope[i] - slope[i + 1]);
        const double bottom = value[i] + 0.5 * slope[i] * kInterval * share;
        if (bottom / bend < kShallow)
          add(dips, i, share, sign * bend);
      }
    }
  }
}

/// Turns dips through 0 into two zeros each, and dips that only touch 0 into one.
KINSHIP_SIMD_INLINE void split(const double* coefficients, Zeros& dips, Zeros& zeros) {
  constexpr double kTouches = 1e-5;  // squared angle
  refine<true>(coefficients, 3, dips);
  for (int first = 0; first < dips.count; first += KINSHIP_SIMD_WIDTH) {
    const WideHarmonic bottom = harmonic_at(coefficients, load(dips.at + first));
    const Wide squared = -2.0 * bottom.value / bottom.bend;
    const Wide off = root(absolute(squared));
    for (int lane = 0; lane < KINSHIP_SIMD_WIDTH && first + lane < dips.count; ++lane) {
      const double at = dips.at[first + lane];
      if (squared[lane] > 0) {
        const double sign = bottom.value[lane] < 0 ? -1 : 1;
        zeros.add(at - off[lane], dips.lower[first + lane], at, sign);
        zeros.add(at + off[lane], at, dips.upper[first + lane], -sign);
      } else if (squared[lane] > -kTouches) {
        zeros.add(at, at, at, 1);
      }
    }
  }
}

/// All angles of joint 3 at which the six equations have a common solution. The resultant is a sum
/// of harmonics up to the eighth; its zeros are searched in intervals of a turn. Two zeros in one
/// interval are found, the second and third of three are not.
KINSHIP_SIMD_INLINE void zeros_of(const SixEquations& equations, const LaneHarmonics& harmonics,
                                  Zeros& zeros) {
  constexpr int kNewtonSteps = 6;
  double determinants[LaneHarmonics::kSamples];
  for (int first = 0; first < LaneHarmonics::kSamples; first += KINSHIP_SIMD_WIDTH) {
    Wide left[kEquations][kEquations];
    store(determinants + first,
          resultant(equations, load(harmonics.cosine + first), load(harmonics.sine + first), left));
  }
  double coefficients[LaneHarmonics::kPadded];
  for (int first = 0; first < LaneHarmonics::kPadded; first += KINSHIP_SIMD_WIDTH) {
    Wide sum{};
    for (int i = 0; i < LaneHarmonics::kSamples; ++i)
      sum += determinants[i] * load(harmonics.to_coefficients[i] + first);
    store(coefficients + first, sum);
  }
  HarmonicScan scanned;
  Zeros dips;
  scan(coefficients, harmonics, scanned);
  sort_intervals(scanned, zeros, dips);
  if (dips.count > 0)
    split(coefficients, dips, zeros);
  refine<false>(coefficients, kNewtonSteps, zeros);
}

}  // namespace
}  // namespace kinship::inverse
