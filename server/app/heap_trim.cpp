#include "server/app/heap_trim.hpp"

#include <malloc.h>

#include <algorithm>

namespace kinship::app {

HeapTrim::TimePoint HeapTrim::beat(TimePoint now, std::size_t participants) {
  constexpr std::chrono::seconds kPeriod{4};
  constexpr std::size_t kWorthIt = 64;
  most_ = std::max(most_, participants);
  if (now < next_)
    return next_;
  next_ = now + kPeriod;
  if (participants + kWorthIt <= most_) {
    most_ = participants;
    malloc_trim(0);
  }
  return next_;
}

}  // namespace kinship::app
