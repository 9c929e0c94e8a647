#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

namespace kinship::runtime {

/// Where the service reads time from. Passed in, so that a test can own it; callable from any
/// thread.
struct Clock {
  /// For deadlines and durations.
  std::function<std::chrono::steady_clock::time_point()> now = [] {
    return std::chrono::steady_clock::now();
  };
  /// Unix time, UTC, for what is stored.
  std::function<std::int64_t()> unix_ms = [] {
    return std::int64_t{std::chrono::duration_cast<std::chrono::milliseconds>(
                            std::chrono::system_clock::now().time_since_epoch())
                            .count()};
  };
};

}  // namespace kinship::runtime
