#pragma once

#include <algorithm>
#include <chrono>

namespace kinship::quotas {

/// How much of something one may take: `per_s` in the mean, `burst` at once after a while of
/// taking nothing. `burst` 0: as much as one likes.
struct Rate {
  double per_s = 0;
  double burst = 0;

  bool is_limited() const noexcept { return burst > 0; }
};

/// What is left of a rate: a bucket that holds `burst` and fills with `per_s`. It may be emptied
/// beyond its bottom, by what is known only once it was taken; then it has to fill up again first.
/// Not shared between threads.
class TokenBucket {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  TokenBucket(const Rate& rate, TimePoint now) : level_(rate.burst), time_(now) {}

  /// How long until that much may be taken; 0: now. More than the bucket holds may be taken when it
  /// is full.
  std::chrono::duration<double> time_until(const Rate& rate, double amount, TimePoint now) {
    if (!rate.is_limited())
      return {};
    fill(rate, now);
    const double missing = std::min(amount, rate.burst) - level_;
    return std::chrono::duration<double>(missing <= 0 ? 0 : missing / rate.per_s);
  }

  void take(const Rate& rate, double amount, TimePoint now) {
    fill(rate, now);
    level_ -= amount;
  }

  bool is_full(const Rate& rate, TimePoint now) {
    if (!rate.is_limited())
      return true;
    fill(rate, now);
    return level_ >= rate.burst;
  }

 private:
  void fill(const Rate& rate, TimePoint now) {
    const std::chrono::duration<double> passed = now - time_;
    time_ = now;
    level_ = std::min(rate.burst, level_ + std::max(0.0, passed.count()) * rate.per_s);
  }

  double level_;
  TimePoint time_;
};

}  // namespace kinship::quotas
