#include "robots/planning/joint_turns.hpp"

namespace kinship::planning {
namespace {

typedef double Pair __attribute__((vector_size(16)));
typedef long long PairBits __attribute__((vector_size(16)));

// Adding and taking away 1.5 * 2^52 rounds to the nearest integer (for values below 2^51).
constexpr double kRounder = 6755399441055744.0;

/// Source: reduction by quarter turns in two parts, W. J. Cody and W. Waite, Software Manual for
/// the Elementary Functions (1980); coefficients of FreeBSD's k_sin.c and k_cos.c.
inline void sine_cosine(const Pair& angle, Pair& sine, Pair& cosine) {
  const Pair shifted = angle * 0.63661977236758134308 + kRounder;
  const PairBits quarter = PairBits(shifted);  // its lowest bits count the quarter turns
  const Pair quarters = shifted - kRounder;
  const Pair r =
      (angle - quarters * 1.57079632673412561417) - quarters * 6.07710050650619224932e-11;
  const Pair z = r * r;
  const Pair s =
      r + r * z *
              (-1.66666666666666324348e-01 +
               z * (8.33333333332248946124e-03 +
                    z * (-1.98412698298579493134e-04 +
                         z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 +
                                                                z * 1.58969099521155010221e-10)))));
  const Pair c =
      1.0 - 0.5 * z +
      z * z *
          (4.16666666666666019037e-02 +
           z * (-1.38888888888741095749e-03 +
                z * (2.48015872894767294178e-05 +
                     z * (-2.75573143513906633035e-07 +
                          z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  // By bits: the baseline compares no integers of 64 bits.
  const PairBits apart = (PairBits(s) ^ PairBits(c)) & -(quarter & 1);  // none, or all of it
  sine = Pair(PairBits(s) ^ apart ^ ((quarter & 2) << 62));
  cosine = Pair(PairBits(c) ^ apart ^ (((quarter + 1) & 2) << 62));
}

}  // namespace

void turn_joints(const double* angles, Eigen::Index count, JointTurns& turns) {
  for (Eigen::Index i = 0; i < count; i += 2) {
    Pair angle, sine, cosine;
    __builtin_memcpy(&angle, angles + i, sizeof angle);
    sine_cosine(angle, sine, cosine);
    __builtin_memcpy(turns.sine + i, &sine, sizeof sine);
    __builtin_memcpy(turns.cosine + i, &cosine, sizeof cosine);
  }
}

}  // namespace kinship::planning
