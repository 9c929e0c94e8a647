#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace kinship::metrics {

/// A number that only grows. May be shared between threads; adding is one relaxed addition.
class Counter {
 public:
  void add(std::uint64_t number = 1) noexcept {
    value_.fetch_add(number, std::memory_order_relaxed);
  }
  std::uint64_t value() const noexcept { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

/// Histogram of durations, with the same buckets for all. May be shared between threads; observing
/// is two relaxed additions and no lock.
class Histogram {
 public:
  /// Upper bounds, s: from an answer from memory to the largest fit. One more bucket has the rest.
  static constexpr std::array<double, 19> kBounds_s = {
      0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1,
      0.25,   0.5,     1,      2.5,   5,      10,    25,   50,    100};

  /// \param seconds  negative values and NaN count as 0.
  void observe(double seconds) noexcept {
    constexpr double kMax_s = 1e9;  // 30 years: nanoseconds fit
    const double duration_s = seconds > 0 ? (seconds < kMax_s ? seconds : kMax_s) : 0;
    std::size_t bucket = 0;
    while (bucket < kBounds_s.size() && duration_s > kBounds_s[bucket])
      ++bucket;
    counts_[bucket].add();
    sum_ns_.add(static_cast<std::uint64_t>(duration_s * 1e9));
  }
  void observe(std::chrono::steady_clock::duration duration) noexcept {
    observe(std::chrono::duration<double>(duration).count());
  }

  /// Count of one bucket, not cumulative; the last one has no bound.
  std::uint64_t count(std::size_t bucket) const noexcept { return counts_[bucket].value(); }
  double sum_s() const noexcept { return static_cast<double>(sum_ns_.value()) * 1e-9; }

 private:
  std::array<Counter, kBounds_s.size() + 1> counts_;
  Counter sum_ns_;
};

}  // namespace kinship::metrics
