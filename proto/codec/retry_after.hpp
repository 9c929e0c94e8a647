#pragma once

#include <algorithm>
#include <cstdint>

#include "proto/types/conversations.hpp"
#include "proto/types/limits.hpp"

/// When to ask again, as a member of messages: never longer than a client may be kept waiting,
/// whoever says so.
namespace kinship::codec {

inline std::uint32_t retry_after_ms(RetryAfter time) {
  return static_cast<std::uint32_t>(std::clamp<RetryAfter::rep>(
      time.count(), 0, static_cast<RetryAfter::rep>(kMaxRetryAfter_ms)));
}

inline RetryAfter read_retry_after(std::uint32_t milliseconds) {
  return RetryAfter(std::min<std::size_t>(milliseconds, kMaxRetryAfter_ms));
}

}  // namespace kinship::codec
