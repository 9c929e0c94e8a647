#pragma once

#include <optional>
#include <string>

#include "proto/dds/participant.hpp"
#include "proto/types/failure.hpp"

/// What the role in a client's credentials has no part in: its permissions would refuse the topics,
/// in words that say less. For sources of proto/dds only.
namespace kinship::dds {

/// Why the participant cannot ask for anything in a conversation ("admin"); nothing if it can.
std::optional<Error> explain_not_allowed(const Participant& participant,
                                         const std::string& conversation);

/// \throws Failure(InvalidInput) if the participant cannot hear of what happens.
void require_events(const Participant& participant);

}  // namespace kinship::dds
