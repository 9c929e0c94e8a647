#pragma once

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/distribution.hpp"

namespace kinship::access {

/// Label of a withheld source; its digest is zeros.
inline constexpr const char* kOtherRobot = "(another robot)";

/// Whether data about several robots must pass withhold_sources() for this caller.
bool withholds_sources(const Caller& caller) noexcept;

/// Removes the identity of a distribution's source robots, except the caller's own: labels,
/// digests, and texts that quote a label. The numbers of their contributions stay.
void withhold_sources(const Caller& caller, Distribution& distribution);

/// The same for a reply to a fetch, with its message and its pose paths. Queries of its library
/// that others recorded lose the UUID of their report; what the server planned for them stays.
void withhold_sources(const Caller& caller, const Digest& fetched_for, FetchReply& reply);

}  // namespace kinship::access
