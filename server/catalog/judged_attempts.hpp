#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "proto/types/advice.hpp"
#include "proto/types/digest.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::catalog {

/// Engines and profile of the distribution that an attempt was planned with.
struct Context {
  std::string engines;  ///< empty: unknown
  std::string profile;

  auto operator<=>(const Context&) const = default;
};

/// By distribution; the context of a missing one is not known, or not any more.
using Contexts = std::map<Digest, Context>;

/// Added to the age of an attempt of an unknown context (not reported, or its distribution was
/// evicted): three half-lives, an eighth of the weight.
inline constexpr std::uint32_t kAgeOfUnknown = 1200;

/// The attempts that guidance of one context is judged from.
struct JudgedAttempts {
  std::vector<JudgedAttempt> attempts;    ///< oldest first, unknown ones aged by kAgeOfUnknown
  std::uint64_t guided = 0, control = 0;  ///< of the context itself
  std::string planner;                    ///< of all of them
};

/// Chooses the attempts: none of another context, which may guide differently, and only of one
/// planner, because the costs of two cannot be compared: the planner with most attempts of the
/// context, or with most of unknown context if there are none. \param known  oldest first.
JudgedAttempts judged_attempts(const Context& context, const Contexts& contexts,
                               std::span<const store::KnownAttempt> known);

/// Adds an attempt newer than all others, which age by one; drops the oldest of its mode beyond
/// store::kKnownAttemptsPerMode.
void add_newest(std::vector<store::KnownAttempt>& known, store::KnownAttempt newest);

}  // namespace kinship::catalog
