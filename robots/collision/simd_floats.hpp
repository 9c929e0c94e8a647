// Vectors of KINSHIP_SIMD_WIDTH floats. Included only by the units that are compiled for one
// instruction set, which define the width: everything has internal linkage.
#pragma once

#ifndef KINSHIP_SIMD_WIDTH
#error "define KINSHIP_SIMD_WIDTH"
#endif

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#define KINSHIP_SIMD_INLINE inline __attribute__((always_inline))

namespace kinship::collision {
namespace {

typedef float Wide __attribute__((vector_size(4 * KINSHIP_SIMD_WIDTH)));
typedef int WideInt __attribute__((vector_size(4 * KINSHIP_SIMD_WIDTH)));

KINSHIP_SIMD_INLINE Wide all(float value) { return value - Wide{}; }

KINSHIP_SIMD_INLINE Wide load(const float* from) {
  Wide value;
  __builtin_memcpy(&value, from, sizeof value);
  return value;
}

KINSHIP_SIMD_INLINE void store(float* to, Wide value) {
  __builtin_memcpy(to, &value, sizeof value);
}

KINSHIP_SIMD_INLINE Wide root(Wide value) {
#if KINSHIP_SIMD_WIDTH == 16
  return Wide(_mm512_maskz_sqrt_ps(0xffff, __m512(value)));
#elif KINSHIP_SIMD_WIDTH == 8
  return Wide(_mm256_sqrt_ps(__m256(value)));
#elif defined(__SSE2__)
  return Wide(_mm_sqrt_ps(__m128(value)));
#else
  for (int lane = 0; lane < KINSHIP_SIMD_WIDTH; ++lane)
    value[lane] = __builtin_sqrtf(value[lane]);
  return value;
#endif
}

KINSHIP_SIMD_INLINE Wide absolute(Wide value) { return Wide(WideInt(value) & 0x7fffffff); }

KINSHIP_SIMD_INLINE Wide positive(Wide value) { return value > 0.0F ? value : Wide{}; }

/// Least value of all lanes.
KINSHIP_SIMD_INLINE float least(Wide value) {
#if defined(__SSE2__)
#if KINSHIP_SIMD_WIDTH == 16
  const __m256 eight =
      _mm256_min_ps(__m256(__builtin_shufflevector(value, value, 0, 1, 2, 3, 4, 5, 6, 7)),
                    __m256(__builtin_shufflevector(value, value, 8, 9, 10, 11, 12, 13, 14, 15)));
#elif KINSHIP_SIMD_WIDTH == 8
  const __m256 eight = __m256(value);
#endif
#if KINSHIP_SIMD_WIDTH == 4
  const __m128 four = __m128(value);
#else
  const __m128 four = _mm_min_ps(_mm256_castps256_ps128(eight), _mm256_extractf128_ps(eight, 1));
#endif
  const __m128 two = _mm_min_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_min_ss(two, _mm_shuffle_ps(two, two, 1)));
#else
  float found = value[0];
  for (int lane = 1; lane < KINSHIP_SIMD_WIDTH; ++lane)
    found = value[lane] < found ? value[lane] : found;
  return found;
#endif
}

KINSHIP_SIMD_INLINE float largest(Wide value) { return -least(-value); }

KINSHIP_SIMD_INLINE Wide larger(Wide a, Wide b) { return a > b ? a : b; }

/// The integers that values from 0 on begin with, at most `last`.
KINSHIP_SIMD_INLINE WideInt whole(Wide value, int last) {
  const Wide limit = all(static_cast<float>(last));
  const Wide within = positive(value);
  return __builtin_convertvector(within < limit ? within : limit, WideInt);
}

KINSHIP_SIMD_INLINE Wide rounded(WideInt value) { return __builtin_convertvector(value, Wide); }

/// The value at each lane's index.
KINSHIP_SIMD_INLINE Wide gather(const float* values, WideInt index) {
#if KINSHIP_SIMD_WIDTH == 16
  return Wide(_mm512_mask_i32gather_ps(__m512(Wide{}), 0xffff, __m512i(index), values, 4));
#elif KINSHIP_SIMD_WIDTH == 8
  return Wide(_mm256_i32gather_ps(values, __m256i(index), 4));
#else
  Wide found;
  for (int lane = 0; lane < KINSHIP_SIMD_WIDTH; ++lane)
    found[lane] = values[index[lane]];
  return found;
#endif
}

/// One bit per lane with a < b.
KINSHIP_SIMD_INLINE unsigned below(Wide a, Wide b) {
#if KINSHIP_SIMD_WIDTH == 16
  return _mm512_cmp_ps_mask(__m512(a), __m512(b), _CMP_LT_OQ);
#elif KINSHIP_SIMD_WIDTH == 8 && defined(__AVX512VL__)
  return _mm256_cmp_ps_mask(__m256(a), __m256(b), _CMP_LT_OQ);
#elif KINSHIP_SIMD_WIDTH == 8
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(__m256(a), __m256(b), _CMP_LT_OQ)));
#elif defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(_mm_cmplt_ps(__m128(a), __m128(b))));
#else
  unsigned bits = 0;
  for (int lane = 0; lane < KINSHIP_SIMD_WIDTH; ++lane)
    bits |= a[lane] < b[lane] ? 1U << lane : 0U;
  return bits;
#endif
}

// Adding and taking away 1.5 * 2^23 rounds to the nearest integer (for values below 2^22).
constexpr float kRounder = 12582912.0F;

/// Sine and cosine, to about 1e-7 for angles in [-4, 4].
/// Source: reduction by quarter turns in two parts, W. J. Cody and W. Waite, Software Manual for
/// the Elementary Functions (1980); coefficients: Taylor's, of the degree that floats need.
KINSHIP_SIMD_INLINE void sine_cosine(Wide angle, Wide& sine, Wide& cosine) {
  const Wide shifted = angle * 0.636619772F + kRounder;
  const WideInt quarter = WideInt(shifted);  // its lowest bits count the quarter turns
  const Wide quarters = shifted - kRounder;
  const Wide r = (angle - quarters * 1.5703125F) - quarters * 4.83826794897e-4F;
  const Wide z = r * r;
  const Wide s =
      r +
      r * z * (-1.66666667e-1F + z * (8.33333333e-3F + z * (-1.98412698e-4F + z * 2.75573192e-6F)));
  const Wide c =
      1.0F - 0.5F * z +
      z * z * (4.16666667e-2F + z * (-1.38888889e-3F + z * (2.48015873e-5F + z * -2.75573192e-7F)));
  const WideInt odd = (quarter & 1) != 0;
  const Wide first = odd ? c : s;
  const Wide second = odd ? s : c;
  sine = (quarter & 2) != 0 ? -first : first;
  cosine = ((quarter + 1) & 2) != 0 ? -second : second;
}

/// A pose in every lane.
struct WideFrame {
  Wide R[9];
  Wide p[3];
};

/// The same in every lane.
KINSHIP_SIMD_INLINE WideFrame standing(const float (&R)[9], const float (&p)[3]) {
  return {{all(R[0]), all(R[1]), all(R[2]), all(R[3]), all(R[4]), all(R[5]), all(R[6]), all(R[7]),
           all(R[8])},
          {all(p[0]), all(p[1]), all(p[2])}};
}

/// A point in every lane.
struct WidePoint {
  Wide x, y, z;
};

KINSHIP_SIMD_INLINE WidePoint moved(const WideFrame& frame, const float (&c)[3]) {
  return {frame.R[0] * c[0] + frame.R[1] * c[1] + frame.R[2] * c[2] + frame.p[0],
          frame.R[3] * c[0] + frame.R[4] * c[1] + frame.R[5] * c[2] + frame.p[1],
          frame.R[6] * c[0] + frame.R[7] * c[1] + frame.R[8] * c[2] + frame.p[2]};
}

/// frame * (R, p)
KINSHIP_SIMD_INLINE void follow(const float (&R)[9], const float (&p)[3], WideFrame& frame) {
#pragma GCC unroll 3
  for (int row = 0; row < 3; ++row) {
    const Wide a = frame.R[3 * row], b = frame.R[3 * row + 1], c = frame.R[3 * row + 2];
    frame.p[row] += a * p[0] + b * p[1] + c * p[2];
    frame.R[3 * row] = a * R[0] + b * R[3] + c * R[6];
    frame.R[3 * row + 1] = a * R[1] + b * R[4] + c * R[7];
    frame.R[3 * row + 2] = a * R[2] + b * R[5] + c * R[8];
  }
}

/// frame * (R, p), R about the x axis.
KINSHIP_SIMD_INLINE void tilt(float sine, float cosine, const float (&p)[3], WideFrame& frame) {
#pragma GCC unroll 3
  for (int row = 0; row < 3; ++row) {
    const Wide a = frame.R[3 * row], b = frame.R[3 * row + 1], c = frame.R[3 * row + 2];
    frame.p[row] += a * p[0] + b * p[1] + c * p[2];
    frame.R[3 * row + 1] = b * cosine + c * sine;
    frame.R[3 * row + 2] = c * cosine - b * sine;
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

}  // namespace
}  // namespace kinship::collision
