#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <random>

namespace kinship::sites {

/// Waiting time before the next try: doubles each time, up to a limit, times a random factor from
/// 0.5 to 1, so that sites that lost the connection together do not reconnect together.
class Backoff {
 public:
  Backoff(std::chrono::milliseconds first, std::chrono::milliseconds longest, std::uint64_t seed)
      : first_(first), longest_(longest), next_(first), generator_(seed) {}

  std::chrono::milliseconds next() {
    std::uniform_real_distribution<double> part(0.5, 1.0);
    const std::chrono::duration<double, std::milli> wait = part(generator_) * next_;
    next_ = std::min(2 * next_, longest_);
    return std::chrono::duration_cast<std::chrono::milliseconds>(wait);
  }
  void reset() { next_ = first_; }

 private:
  const std::chrono::milliseconds first_, longest_;
  std::chrono::milliseconds next_;
  std::mt19937_64 generator_;
};

}  // namespace kinship::sites
