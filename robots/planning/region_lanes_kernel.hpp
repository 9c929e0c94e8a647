// Projections side by side. Included only by the units that are compiled for one instruction set:
// everything has internal linkage.
#include "robots/planning/region_lanes.hpp"

namespace kinship::planning {
namespace {

#define KINSHIP_LANES inline __attribute__((always_inline))

typedef float Wide __attribute__((vector_size(4 * kSideBySide)));
typedef int WideInt __attribute__((vector_size(4 * kSideBySide)));

constexpr float kHalfTurn = 3.14159265F;
constexpr float kRounder = 12582912.0F;  // adding and taking it away rounds, below 2^22

KINSHIP_LANES Wide all(float value) { return Wide{} + value; }
KINSHIP_LANES Wide load(const float* values) {
  Wide wide;
  __builtin_memcpy(&wide, values, sizeof wide);
  return wide;
}
KINSHIP_LANES Wide greater(Wide a, Wide b) { return a > b ? a : b; }
KINSHIP_LANES Wide lesser(Wide a, Wide b) { return a < b ? a : b; }
KINSHIP_LANES Wide magnitude(Wide a) { return Wide(WideInt(a) & 0x7fffffff); }
KINSHIP_LANES Wide with_sign(Wide a, Wide sign) {
  return Wide(WideInt(a) | (WideInt(sign) & static_cast<int>(0x80000000U)));
}
KINSHIP_LANES Wide root(Wide a) {
  for (int lane = 0; lane < kSideBySide; ++lane)
    a[lane] = __builtin_sqrtf(a[lane]);
  return a;
}

/// Source: reduction by quarter turns in two parts, W. J. Cody and W. Waite, Software Manual for
/// the Elementary Functions (1980); coefficients: Taylor's, of the degree that floats need.
KINSHIP_LANES void sine_cosine(Wide angle, Wide& sine, Wide& cosine) {
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
  const Wide first = odd ? c : s, second = odd ? s : c;
  sine = (quarter & 2) != 0 ? -first : first;
  cosine = ((quarter + 1) & 2) != 0 ? -second : second;
}

/// To about 1e-5. Source: coefficients of the minimax polynomial of degree 11 on [0, 1].
KINSHIP_LANES Wide arc(Wide y, Wide x) {
  const Wide up = magnitude(y), along = magnitude(x);
  const Wide larger = greater(greater(up, along), all(1e-30F));
  const Wide a = lesser(up, along) / larger, s = a * a;
  Wide angle =
      a * (0.99997726F +
           s * (-0.33262347F +
                s * (0.19354346F + s * (-0.11643287F + s * (0.05265332F + s * -0.01172120F)))));
  angle = up > along ? kHalfTurn / 2 - angle : angle;
  angle = x < 0.0F ? kHalfTurn - angle : angle;
  return with_sign(angle, y);
}

/// Poses along the chain.
struct LaneSweep {
  Wide origin[kLaneJoints][3], axis[kLaneJoints][3];
  Wide R[9], p[3];
};

template <bool kHasPlace>
KINSHIP_LANES void follow(const float (&R_next)[9], const float (&p_next)[3], Wide (&R)[9],
                          Wide (&p)[3]) {
#pragma GCC unroll 3
  for (int row = 0; row < 3; ++row) {
    const Wide a = R[3 * row], b = R[3 * row + 1], c = R[3 * row + 2];
    if (kHasPlace)
      p[row] += a * p_next[0] + b * p_next[1] + c * p_next[2];
    R[3 * row] = a * R_next[0] + b * R_next[3] + c * R_next[6];
    R[3 * row + 1] = a * R_next[1] + b * R_next[4] + c * R_next[7];
    R[3 * row + 2] = a * R_next[2] + b * R_next[5] + c * R_next[8];
  }
}

/// \tparam kHasPlace  whether positions are wanted, too.
template <bool kHasPlace>
KINSHIP_LANES void sweep_along(const LaneRegion& region, const float* qs, LaneSweep& along) {
  Wide R[9], p[3];
  for (int i = 0; i < 9; ++i)
    R[i] = all(region.joints[0].R[i]);
  for (int i = 0; i < 3; ++i)
    p[i] = all(region.joints[0].p[i]);
  for (int joint = 0; joint < region.dof; ++joint) {
    if (joint > 0)
      follow<kHasPlace>(region.joints[joint].R, region.joints[joint].p, R, p);
    for (int i = 0; i < 3; ++i) {
      along.origin[joint][i] = p[i];
      along.axis[joint][i] = R[3 * i + 2];
    }
    const Wide q = load(qs + kSideBySide * joint);
    if (region.joints[joint].slides) {
      for (int i = 0; i < 3; ++i)
        p[i] += q * R[3 * i + 2];
      continue;
    }
    Wide s, c;
    sine_cosine(q, s, c);
    for (int i = 0; i < 3; ++i) {
      const Wide x = R[3 * i], y = R[3 * i + 1];
      R[3 * i] = c * x + s * y;
      R[3 * i + 1] = c * y - s * x;
    }
  }
  follow<kHasPlace>(region.R_end, region.p_end, R, p);
  for (int i = 0; i < 9; ++i)
    along.R[i] = R[i];
  for (int i = 0; i < 3; ++i)
    along.p[i] = p[i];
}

KINSHIP_LANES void sweep(const LaneRegion& region, const float* qs, LaneSweep& along) {
  if (region.has_place)
    sweep_along<true>(region, qs, along);
  else
    sweep_along<false>(region, qs, along);
}

/// Displacement beyond the bounds, a value per bounded coordinate.
struct LaneExcess {
  Wide beyond[6];
  Wide squared;
  WideInt flipped;  ///< the rotation counts as (roll + pi, pi - pitch, yaw + pi)
  Wide cosine;      ///< of the pitch
};

KINSHIP_LANES Wide beyond(Wide value, float lower, float upper) {
  return value > upper ? value - upper : lesser(value - lower, Wide{});
}

KINSHIP_LANES Wide angle_beyond(Wide angle, float lower, float upper) {
  const float middle = (lower + upper) / 2;
  const Wide apart = angle - middle;
  const Wide turns = (apart * (0.5F / kHalfTurn) + kRounder) - kRounder;
  return beyond(middle + (apart - turns * (2 * kHalfTurn)), lower, upper);
}

KINSHIP_LANES void exceed(const LaneRegion& region, const LaneSweep& along, LaneExcess& excess) {
  const Wide* R = along.R;
  const Wide level = root(R[0] * R[0] + R[3] * R[3]);
  excess.cosine = greater(level, all(region.least_cosine));
  Wide one[6], other[6], one_squared = {}, other_squared = {}, squared = {};
  for (int i = 0; i < region.row_count; ++i) {
    const int row = region.rows[i];
    const float lower = region.lower[row], upper = region.upper[row];
    if (row < 3) {
      one[i] = other[i] = beyond(along.p[row], lower, upper);
      squared += one[i] * one[i];
      continue;
    }
    const Wide angle = row == 3 ? arc(R[7], R[8]) : row == 4 ? arc(-R[6], level) : arc(R[3], R[0]);
    one[i] = angle_beyond(angle, lower, upper);
    other[i] = angle_beyond(row == 4 ? kHalfTurn - angle : angle + kHalfTurn, lower, upper);
    one_squared += one[i] * one[i];
    other_squared += other[i] * other[i];
  }
  excess.flipped = other_squared < one_squared;
  excess.squared = squared + (excess.flipped ? other_squared : one_squared);
  for (int i = 0; i < region.row_count; ++i)
    excess.beyond[i] = excess.flipped ? other[i] : one[i];
}

/// Of the coordinates that are outside, per joint; zero for the others.
KINSHIP_LANES void derive(const LaneRegion& region, const LaneSweep& along,
                          const LaneExcess& excess, Wide (&J)[kLaneJoints][6]) {
  const Wide share = 1.0F / excess.cosine;
  const Wide cosine = along.R[0] * share, sine = along.R[3] * share, rise = -along.R[6] * share;
  for (int joint = 0; joint < region.dof; ++joint) {
    const Wide* axis = along.axis[joint];
    const bool slides = region.joints[joint].slides;
    const Wide rolls = (cosine * axis[0] + sine * axis[1]);
    const Wide pitches = cosine * axis[1] - sine * axis[0];
    Wide arm[3];
    for (int i = 0; i < 3; ++i)
      arm[i] = along.p[i] - along.origin[joint][i];
    for (int i = 0; i < region.row_count; ++i) {
      const int row = region.rows[i];
      Wide rate = {};
      if (row < 3) {
        const int next = (row + 1) % 3, last = (row + 2) % 3;
        rate = slides ? axis[row] : axis[next] * arm[last] - axis[last] * arm[next];
      } else if (!slides) {
        rate = row == 3   ? rolls * share
               : row == 4 ? (excess.flipped ? -pitches : pitches)
                          : rolls * rise + axis[2];
      }
      J[joint][i] = excess.beyond[i] != 0.0F ? rate : Wide{};
    }
  }
}

/// (J J^T + damping)^-1 wanted, by a decomposition without roots.
KINSHIP_LANES void solve(const LaneRegion& region, const Wide (&J)[kLaneJoints][6],
                         Wide (&wanted)[6]) {
  const int count = region.row_count;
  Wide L[6][6], D[6];
  for (int i = 0; i < count; ++i)
    for (int j = 0; j <= i; ++j) {
      Wide sum = i == j ? all(region.squared_damping) : Wide{};
      for (int joint = 0; joint < region.dof; ++joint)
        sum += J[joint][i] * J[joint][j];
      L[i][j] = sum;
    }
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < i; ++j) {
      for (int k = 0; k < j; ++k)
        L[i][j] -= L[i][k] * L[j][k] * D[k];
      L[i][j] = L[i][j] / D[j];
    }
    D[i] = L[i][i];
    for (int k = 0; k < i; ++k)
      D[i] -= L[i][k] * L[i][k] * D[k];
  }
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < i; ++k)
      wanted[i] -= L[i][k] * wanted[k];
  for (int i = count - 1; i >= 0; --i) {
    wanted[i] = wanted[i] / D[i];
    for (int k = i + 1; k < count; ++k)
      wanted[i] -= L[k][i] * wanted[k];
  }
}

KINSHIP_LANES unsigned project_lanes(const LaneRegion& region, float* qs) {
  LaneSweep along;
  LaneExcess excess;
  Wide J[kLaneJoints][6], wanted[6];
  for (int joint = 0; joint < region.dof; ++joint) {  // rounding may have left them
    Wide q = load(qs + kSideBySide * joint);
    q = lesser(greater(q, all(region.least[joint])), all(region.most[joint]));
    __builtin_memcpy(qs + kSideBySide * joint, &q, sizeof q);
  }
  for (int iteration = 0;; ++iteration) {
    sweep(region, qs, along);
    exceed(region, along, excess);
    const WideInt out = excess.squared > region.aimed_squared;
    unsigned arrived = 0;
    for (int lane = 0; lane < kSideBySide; ++lane)
      arrived |= out[lane] == 0 ? 1U << lane : 0U;
    if (arrived == (1U << kSideBySide) - 1 || iteration == kLaneIterations)
      return arrived;
    derive(region, along, excess, J);
    for (int i = 0; i < region.row_count; ++i) {
      const Wide aim = with_sign(all(region.margin[region.rows[i]]), excess.beyond[i]);
      wanted[i] = excess.beyond[i] != 0.0F ? excess.beyond[i] + aim : Wide{};
    }
    solve(region, J, wanted);
    for (int joint = 0; joint < region.dof; ++joint) {
      const Wide q = load(qs + kSideBySide * joint);
      Wide moved = q;
      for (int i = 0; i < region.row_count; ++i)
        moved -= J[joint][i] * wanted[i];
      moved = lesser(greater(moved, all(region.least[joint])), all(region.most[joint]));
      moved = out ? moved : q;
      __builtin_memcpy(qs + kSideBySide * joint, &moved, sizeof moved);
    }
  }
}

KINSHIP_LANES void measure_lanes(const LaneRegion& region, const float* qs, float* squared) {
  LaneSweep along;
  LaneExcess excess;
  sweep(region, qs, along);
  exceed(region, along, excess);
  __builtin_memcpy(squared, &excess.squared, sizeof excess.squared);
}

}  // namespace
}  // namespace kinship::planning
