// Vectors of KINSHIP_SIMD_WIDTH doubles. Included only by the units that are compiled for one
// instruction set, which define the width: everything has internal linkage.
#pragma once

#ifndef KINSHIP_SIMD_WIDTH
#error "define KINSHIP_SIMD_WIDTH"
#endif

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "robots/inverse/lanes.hpp"

#define KINSHIP_SIMD_INLINE inline __attribute__((always_inline))

namespace kinship::inverse {
namespace {

typedef double Wide __attribute__((vector_size(8 * KINSHIP_SIMD_WIDTH)));
typedef long long WideMask __attribute__((vector_size(8 * KINSHIP_SIMD_WIDTH)));

KINSHIP_SIMD_INLINE Wide all(double value) { return value - Wide{}; }

KINSHIP_SIMD_INLINE Wide load(const double* from) {
  Wide value;
  __builtin_memcpy(&value, from, sizeof value);
  return value;
}

KINSHIP_SIMD_INLINE void store(double* to, Wide value) {
  __builtin_memcpy(to, &value, sizeof value);
}

KINSHIP_SIMD_INLINE Wide root(Wide value) {
#if KINSHIP_SIMD_WIDTH == 8
  return Wide(_mm512_maskz_sqrt_pd(0xff, __m512d(value)));
#elif KINSHIP_SIMD_WIDTH == 4
  return Wide(_mm256_sqrt_pd(__m256d(value)));
#elif defined(__SSE2__)
  return Wide(_mm_sqrt_pd(__m128d(value)));
#else
  for (int lane = 0; lane < KINSHIP_SIMD_WIDTH; ++lane)
    value[lane] = __builtin_sqrt(value[lane]);
  return value;
#endif
}

/// Bit i: the mask is set in lane i.
KINSHIP_SIMD_INLINE unsigned bits(WideMask mask) {
#if KINSHIP_SIMD_WIDTH == 8
  return _mm512_movepi64_mask(__m512i(mask));
#elif KINSHIP_SIMD_WIDTH == 4
  return static_cast<unsigned>(_mm256_movemask_pd(__m256d(mask)));
#elif defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_pd(__m128d(mask)));
#else
  unsigned result = 0;
  for (int lane = 0; lane < KINSHIP_SIMD_WIDTH; ++lane)
    result |= (mask[lane] != 0 ? 1U : 0U) << lane;
  return result;
#endif
}

KINSHIP_SIMD_INLINE Wide clamped(Wide value, Wide lower, Wide upper) {
  value = value < lower ? lower : value;
  return value > upper ? upper : value;
}

KINSHIP_SIMD_INLINE Wide absolute(Wide value) { return value < 0.0 ? -value : value; }

// Adding and taking away 1.5 * 2^52 rounds to the nearest integer (for values below 2^51).
constexpr double kRounder = 6755399441055744.0;

constexpr double kTurnOf = 6.283185307179586477;

/// The angle moved by whole turns into [-pi, pi].
KINSHIP_SIMD_INLINE Wide wrapped(Wide angle) {
  const Wide turns = (angle * (1 / kTurnOf) + kRounder) - kRounder;
  return angle - turns * kTurnOf;
}

/// Sine and cosine, to about 1e-16 for angles below 1e5.
/// Source: reduction by quarter turns in two parts, W. J. Cody and W. Waite, Software Manual for
/// the Elementary Functions (1980); coefficients of FreeBSD's k_sin.c and k_cos.c.
KINSHIP_SIMD_INLINE void sine_cosine(Wide angle, Wide& sine, Wide& cosine) {
  const Wide shifted = angle * 0.63661977236758134308 + kRounder;
  const WideMask quarter = WideMask(shifted);  // its lowest bits count the quarter turns
  const Wide quarters = shifted - kRounder;
  const Wide r =
      (angle - quarters * 1.57079632673412561417) - quarters * 6.07710050650619224932e-11;
  const Wide z = r * r;
  const Wide s =
      r + r * z *
              (-1.66666666666666324348e-01 +
               z * (8.33333333332248946124e-03 +
                    z * (-1.98412698298579493134e-04 +
                         z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 +
                                                                z * 1.58969099521155010221e-10)))));
  const Wide c =
      1.0 - 0.5 * z +
      z * z *
          (4.16666666666666019037e-02 +
           z * (-1.38888888888741095749e-03 +
                z * (2.48015872894767294178e-05 +
                     z * (-2.75573143513906633035e-07 +
                          z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  const WideMask odd = (quarter & 1) != 0;
  const Wide first = odd ? c : s;
  const Wide second = odd ? s : c;
  sine = (quarter & 2) != 0 ? -first : first;
  cosine = ((quarter + 1) & 2) != 0 ? -second : second;
}

/// The angle of a direction in the plane, to 2e-8.
/// Source: M. Abramowitz and I. Stegun, Handbook of Mathematical Functions (1964), 4.4.49.
KINSHIP_SIMD_INLINE Wide angle_of(Wide sine, Wide cosine) {
  const Wide s = absolute(sine), c = absolute(cosine);
  const WideMask steep = s > c;
  const Wide t = (steep ? c : s) / (steep ? s : c);
  const Wide z = t * t;
  const Wide arc =
      t + t * z *
              (-0.3333314528 +
               z * (0.1999355085 +
                    z * (-0.1420889944 +
                         z * (0.1065626393 +
                              z * (-0.0752896400 +
                                   z * (0.0429096138 + z * (-0.0161657367 + z * 0.0028662257)))))));
  const Wide first = steep ? 0.25 * kTurnOf - arc : arc;
  const Wide half = cosine < 0.0 ? 0.5 * kTurnOf - first : first;
  return sine < 0.0 ? -half : half;
}

/// The same to about 1e-16 for a sine and cosine of unit length: the rest is a sine of 2e-8.
KINSHIP_SIMD_INLINE Wide exact_angle_of(Wide sine, Wide cosine) {
  const Wide near = angle_of(sine, cosine);
  Wide near_sine, near_cosine;
  sine_cosine(near, near_sine, near_cosine);
  return near + (sine * near_cosine - cosine * near_sine);
}

/// Sines and cosines of all joints: computed side by side, before the poses, which depend on each
/// other.
struct WideTurns {
  Wide sine[kLaneJoints], cosine[kLaneJoints];
};

/// A pose in every lane.
struct WideFrame {
  Wide R[9];
  Wide p[3];
};

KINSHIP_SIMD_INLINE WideFrame frame_of(const double* R, const double* p) {
  WideFrame frame;
  for (int i = 0; i < 9; ++i)
    frame.R[i] = all(R[i]);
  for (int i = 0; i < 3; ++i)
    frame.p[i] = all(p[i]);
  return frame;
}

/// frame * (R, p)
KINSHIP_SIMD_INLINE void follow(const double* R, const double* p, WideFrame& frame) {
#pragma GCC unroll 3
  for (int row = 0; row < 3; ++row) {
    const Wide a = frame.R[3 * row], b = frame.R[3 * row + 1], c = frame.R[3 * row + 2];
    frame.p[row] += a * p[0] + b * p[1] + c * p[2];
    frame.R[3 * row] = a * R[0] + b * R[3] + c * R[6];
    frame.R[3 * row + 1] = a * R[1] + b * R[4] + c * R[7];
    frame.R[3 * row + 2] = a * R[2] + b * R[5] + c * R[8];
  }
}

/// Turned about its own z axis.
KINSHIP_SIMD_INLINE void turn(Wide s, Wide c, WideFrame& frame) {
#pragma GCC unroll 3
  for (int row = 0; row < 3; ++row) {
    const Wide x = frame.R[3 * row], y = frame.R[3 * row + 1];
    frame.R[3 * row] = x * c + y * s;
    frame.R[3 * row + 1] = y * c - x * s;
  }
}

/// From the frame to the target: x, y, z, then 2 sin(angle / 2) times the axis, in the base.
KINSHIP_SIMD_INLINE void task_error(const Wide (&target)[12], const WideFrame& frame,
                                    Wide (&error)[6]) {
  Wide D[9];  // target * frame^T
#pragma GCC unroll 9
  for (int i = 0; i < 9; ++i) {
    const Wide *a = target + i / 3 * 3, *b = frame.R + i % 3 * 3;
    D[i] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  const Wide trace = 1.0 + D[0] + D[4] + D[8];  // (2 cos(angle / 2))^2
  // At half a turn the axis cannot be told from D - D^T. Any direction leads away from there.
  const WideMask half_turn = trace < 1e-8;
  const Wide scale = 1.0 / root(half_turn ? all(1) : trace);
  for (int i = 0; i < 3; ++i)
    error[i] = target[9 + i] - frame.p[i];
  error[3] = half_turn ? all(1) : scale * (D[7] - D[5]);
  error[4] = half_turn ? all(1) : scale * (D[2] - D[6]);
  error[5] = half_turn ? all(1) : scale * (D[3] - D[1]);
}

}  // namespace
}  // namespace kinship::inverse
