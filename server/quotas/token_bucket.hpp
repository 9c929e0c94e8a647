#pragma once

#include <algorithm>
#include <chrono>

namespace kinship::quotas {

/// A rate limit: `per_s` in the mean, `burst` at once after an idle time. `burst` 0: no limit.
struct Rate {
  double per_s = 0;
  double burst = 0;

  bool is_limited() const noexcept { return burst > 0; }
};

/// The remainder of a rate: a bucket that holds `burst` and fills with `per_s`. Its level may
/// become negative, by amounts known only once they were taken; then it has to refill first. Not
/// shared between threads.
class TokenBucket {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  TokenBucket(const Rate& rate, TimePoint now) : level_(rate.burst), time_(now) {}

  /// Time until `amount` may be taken; 0: now. More than the bucket holds may be taken when it is
  /// full.
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
