#pragma once

#include <optional>
#include <string>

#include "proto/dds/participant.hpp"
#include "proto/types/failure.hpp"

/// Checks a client's role before it creates topics: its permissions would refuse them with a less
/// helpful message. For sources of proto/dds only.
namespace kinship::dds {

/// Why the participant cannot send requests in a conversation ("admin"); nothing if it can.
std::optional<Error> explain_not_allowed(const Participant& participant,
                                         const std::string& conversation);

/// \throws Failure(InvalidInput) if the participant may not receive events.
void require_events(const Participant& participant);

}  // namespace kinship::dds
