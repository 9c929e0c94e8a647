#pragma once

#include <algorithm>
#include <cstdint>

#include "proto/types/conversations.hpp"
#include "proto/types/limits.hpp"

/// The time until a retry as a member of messages: at most kMaxRetryAfter_ms, also when it is read.
namespace kinship::codec {

inline std::uint32_t retry_after_ms(RetryAfter time) {
  return static_cast<std::uint32_t>(std::clamp<RetryAfter::rep>(
      time.count(), 0, static_cast<RetryAfter::rep>(kMaxRetryAfter_ms)));
}

inline RetryAfter read_retry_after(std::uint32_t milliseconds) {
  return RetryAfter(std::min<std::size_t>(milliseconds, kMaxRetryAfter_ms));
}

}  // namespace kinship::codec
