#pragma once

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/distribution.hpp"

namespace kinship::access {

/// What a withheld source is called; its digest is zeros.
inline constexpr const char* kOtherRobot = "(another robot)";

/// Whether what is about several robots has to go through withhold_sources() for this caller.
bool withholds_sources(const Caller& caller) noexcept;

/// Takes out which robots, beside the caller's own, a distribution was made of: labels, digests,
/// and texts that quote a label. What they contributed stays, in numbers.
void withhold_sources(const Caller& caller, Distribution& distribution);

/// The same of a reply to a fetch, its message and its ways.
void withhold_sources(const Caller& caller, const Digest& fetched_for, FetchReply& reply);

}  // namespace kinship::access
