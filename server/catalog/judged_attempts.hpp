#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "proto/types/advice.hpp"
#include "proto/types/digest.hpp"
#include "server/store/store.hpp"

namespace kinship::catalog {

/// What made the distribution that an attempt was planned with.
struct Context {
  std::string engines;  ///< empty: nobody knows
  std::string profile;

  auto operator<=>(const Context&) const = default;
};

/// By distribution; a missing one is not known, or not any more.
using Contexts = std::map<Digest, Context>;

/// An attempt of an unknown context (its client did not say, its distribution was evicted) counts
/// as if so many more had followed: three half-lives, an eighth of the weight.
inline constexpr std::uint32_t kAgeOfUnknown = 1200;

/// What guidance of one context is judged from.
struct JudgedAttempts {
  std::vector<JudgedAttempt> attempts;    ///< oldest first, unknown ones aged by kAgeOfUnknown
  std::uint64_t guided = 0, control = 0;  ///< of the context itself
  std::string planner;                    ///< of all of them
};

/// Chooses them: none of another context, which may guide otherwise; those of one planner, because
/// checks of two cannot be compared; of the planner that has most attempts of the context, or most
/// of all if there are none. \param known  oldest first.
JudgedAttempts judged_attempts(const Context& context, const Contexts& contexts,
                               std::span<const store::KnownAttempt> known);

/// An attempt newer than all others, which age by one; drops the oldest of its mode beyond
/// store::kKnownAttemptsPerMode.
void add_newest(std::vector<store::KnownAttempt>& known, store::KnownAttempt newest);

}  // namespace kinship::catalog
