#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"

/// What this machine's processor does at best, beside figures that have no peer: a budget of
/// seconds would be kept or missed by the machine.
namespace kinship::bench {

namespace processor {

constexpr int kChains = 16;  // of dependent operations: enough to fill every pipeline
constexpr int kRounds = 1'000'000;

using Two [[gnu::vector_size(16)]] = double;
using Four [[gnu::vector_size(32)]] = double;
using Eight [[gnu::vector_size(64)]] = double;

/// kChains * kRounds fused multiply-adds of vectors.
template <typename Vector>
[[gnu::always_inline]] inline double multiply_and_add() {
  Vector values[kChains] = {};  // NOLINT: std::array forgets that they are vectors
  for (int i = 0; i < kChains; ++i)
    values[i] += i;  // each its own, or one is computed for all
  const Vector factor = Vector{} + 0.999999, summand = Vector{} + 1e-6;
  for (int round = 0; round < kRounds; ++round)
#pragma GCC unroll 16
    for (Vector& each : values)
      each = each * factor + summand;
  Vector sum{};
  for (const Vector& each : values)
    sum += each;
  return sum[0];
}

[[gnu::target("avx512f,fma"), gnu::noinline]] inline double with_avx512() {
  return multiply_and_add<Eight>();
}
[[gnu::target("avx2,fma"), gnu::noinline]] inline double with_avx2() {
  return multiply_and_add<Four>();
}
[[gnu::noinline]] inline double with_sse2() { return multiply_and_add<Two>(); }

inline double measure_per_s() {
  const bool is_widest = __builtin_cpu_supports("avx512f") != 0;
  const bool is_wide = __builtin_cpu_supports("avx2") != 0;
  const int lanes = is_widest ? 8 : is_wide ? 4 : 2;
  double sum = 0;
  constexpr int kRuns = 25;  // a neighbour on the same core takes half of it
  const double taken_s = least_s(kRuns, thread_cpu_s, [&] {
    sum += is_widest ? with_avx512() : is_wide ? with_avx2() : with_sse2();
  });
  if (sum <= 0)
    throw std::logic_error("the reference was optimised away");
  return lanes * (static_cast<double>(kChains) * kRounds / taken_s);
}

}  // namespace processor

/// Fused multiply-adds of doubles a second, one thread, widest instructions, CPU time.
inline double multiply_adds_per_s() {
  static const double per_s = processor::measure_per_s();
  return per_s;
}

inline std::string in_words(double multiply_adds) {
  std::ostringstream text;
  text << multiply_adds << " multiply-adds at best";
  return text.str();
}

/// The time that so many take, for a figure of time.
/// \param unit_s  the figure's unit, s
inline Reference time_at_best(double multiply_adds, double unit_s) {
  return {in_words(multiply_adds), multiply_adds / multiply_adds_per_s() / unit_s};
}

/// For a figure in things a second: as many as if each took so many.
inline Reference rate_at_best(double multiply_adds) {
  return {"each " + in_words(multiply_adds), multiply_adds_per_s() / multiply_adds};
}

}  // namespace kinship::bench
