#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/quotas/token_bucket.hpp"

namespace kinship::quotas {

/// Resources with a limit per client; kQuotaNames has their names.
enum class Quota : std::uint8_t {
  Attempts,  ///< a second
  Bytes,     ///< a second, sent and received
  Waiting,   ///< requests that wait at a time, including attempts not yet answered
  Leases,    ///< at a time
  Fits,      ///< at a time
  Robots,    ///< that were not known, a day
  Tasks,     ///< that were not known, a day
  Stored     ///< bytes of paths, a day
};

inline constexpr std::array<std::string_view, 8> kQuotaNames = {
    "attempts", "bytes", "waiting", "leases", "fits", "robots", "tasks", "stored_bytes"};

/// Answer to a client that is over a quota.
struct Refusal {
  Quota quota = Quota::Attempts;
  std::chrono::milliseconds retry_after{0};  ///< kMaxRetryAfter_ms at most: the client asks again
  std::string message;
};

/// Rates of one client; 0: no limit. Limits on what it holds at a time are in ServiceOptions and
/// catalog::CatalogState::Limits.
struct ClientRates {
  double attempts_per_s = 1000;
  double bytes_per_s = 16e6;
  double robots_per_day = 2000;
  double tasks_per_day = 2000;
  double stored_bytes_per_day = 16e9;
  /// Clients counted separately. Others are counted as one, as long as none of these is idle.
  std::size_t max_clients = 2048;
};

}  // namespace kinship::quotas
