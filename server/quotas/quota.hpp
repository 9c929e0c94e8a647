#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/quotas/token_bucket.hpp"

namespace kinship::quotas {

/// Of what one client may have so much; kQuotaNames are the words for it.
enum class Quota : std::uint8_t {
  Attempts,  ///< a second
  Bytes,     ///< a second, sent and received
  Waiting,   ///< requests that wait at a time, attempts on their way among them
  Leases,    ///< at a time
  Fits,      ///< at a time
  Robots,    ///< that were not known, a day
  Tasks,     ///< that were not known, a day
  Stored     ///< bytes of paths, a day
};

inline constexpr std::array<std::string_view, 8> kQuotaNames = {
    "attempts", "bytes", "waiting", "leases", "fits", "robots", "tasks", "stored_bytes"};

/// What a client is told that may not have something now.
struct Refusal {
  Quota quota = Quota::Attempts;
  std::chrono::milliseconds retry_after{0};  ///< kMaxRetryAfter_ms at most: the client asks again
  std::string message;
};

/// What one client may take in the course of time; 0: as much as it likes. What it may have at a
/// time is bounded where it is: ServiceOptions, catalog::CatalogState::Limits.
struct ClientRates {
  double attempts_per_s = 1000;
  double bytes_per_s = 16e6;
  double robots_per_day = 2000;
  double tasks_per_day = 2000;
  double stored_bytes_per_day = 16e9;
  /// That are told apart. What others take is counted as of one, as long as none of these is idle.
  std::size_t max_clients = 2048;
};

}  // namespace kinship::quotas
