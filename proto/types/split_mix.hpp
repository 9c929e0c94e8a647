#pragma once

#include <cstdint>

namespace kinship {

/// Increment of the state of SplitMix64: 2^64 / golden ratio, odd.
inline constexpr std::uint64_t kSplitMixStep = 0x9e3779b97f4a7c15;

/// A bijection of 64 bits in which every bit of the input reaches every bit of the output.
/// Source: Steele, Lea and Flood, Fast splittable pseudorandom number generators (2014), fig. 17.
constexpr std::uint64_t split_mixed(std::uint64_t bits) noexcept {
  bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9;
  bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111eb;
  return bits ^ (bits >> 31U);
}

/// From 0 to below 1, a multiple of 2^-53.
constexpr double unit_interval(std::uint64_t bits) noexcept {
  return static_cast<double>(bits >> 11U) * 0x1p-53;
}

}  // namespace kinship
