#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

namespace kinship::runtime {

/// The clock of the service. Passed in, so that a test can replace it; callable from any thread.
struct Clock {
  /// For deadlines and durations.
  std::function<std::chrono::steady_clock::time_point()> now = [] {
    return std::chrono::steady_clock::now();
  };
  /// Unix time, UTC, for stored times.
  std::function<std::int64_t()> unix_ms = [] {
    return std::int64_t{std::chrono::duration_cast<std::chrono::milliseconds>(
                            std::chrono::system_clock::now().time_since_epoch())
                            .count()};
  };
};

}  // namespace kinship::runtime
