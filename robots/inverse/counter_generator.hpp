#pragma once

#include <Eigen/Geometry>
#include <bit>
#include <cstdint>

#include "proto/types/split_mix.hpp"

namespace kinship::inverse {

/// Random numbers that are a pure function of a key and a counter, so that results depend neither
/// on threads nor on the order in which poses are solved.
/// Source: Steele, Lea and Flood, Fast splittable pseudorandom number generators (2014):
/// SplitMix64.
class CounterGenerator {
 public:
  explicit CounterGenerator(std::uint64_t key) noexcept : state_(key) {}

  /// Keyed by a seed and the exact bits of a pose.
  CounterGenerator(std::uint64_t seed, const Eigen::Isometry3d& pose) noexcept
      : state_(split_mixed(seed)) {
    for (Eigen::Index row = 0; row < 3; ++row)
      for (Eigen::Index column = 0; column < 4; ++column)  // adding 0 turns -0 into 0
        state_ = split_mixed(state_ ^ std::bit_cast<std::uint64_t>(pose(row, column) + 0.0));
  }

  /// A separate generator for one of many attempts; this one does not change.
  CounterGenerator of_attempt(std::uint64_t attempt) const noexcept {
    return CounterGenerator(split_mixed(state_ ^ split_mixed(attempt + kSplitMixStep)));
  }

  std::uint64_t next() noexcept {
    state_ += kSplitMixStep;
    return split_mixed(state_);
  }

  /// Uniform in [0, 1).
  double uniform() noexcept { return unit_interval(next()); }

 private:
  std::uint64_t state_;
};

}  // namespace kinship::inverse
