#pragma once

#include <chrono>
#include <cstdint>

namespace kinship::store {

/// Unix time, UTC; for human readers of rows. Order and freshness never depend on it.
inline std::int64_t now_ms() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(since_epoch).count();
}

}  // namespace kinship::store
