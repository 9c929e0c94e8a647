#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "proto/types/result.hpp"

namespace kinship {

enum class OutcomeFilter { All, Solved, Unsolved, Timeout, Failed };
enum class AttemptOrder {
  Newest,  ///< the newest first
  Slowest  ///< by planning time, of the newest kMaxSlowestOf that match
};

inline constexpr std::size_t kMaxSlowestOf = 10'000;

/// The attempts that FindAttempts lists, as its argument says.
struct AttemptFilter {
  OutcomeFilter outcome = OutcomeFilter::All;
  std::int64_t since_ms = 0;  ///< received at or after, Unix time, UTC; 0: all
  AttemptOrder order = AttemptOrder::Newest;

  bool operator==(const AttemptFilter&) const = default;
};

/// "outcome=unsolved,since_ms=1700000000000,order=slowest", without what is the default.
std::string to_text(const AttemptFilter& filter);

/// \return InvalidInput that names what is no part of a filter.
Result<AttemptFilter> attempt_filter_from_text(std::string_view text);

}  // namespace kinship
