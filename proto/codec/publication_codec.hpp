#pragma once

#include <optional>

#include "proto/codec/message.hpp"
#include "proto/idl/publication.h"

namespace kinship::codec {

/// The rule of the contract that an event breaks, if any.
std::optional<Error> validate(const Event& event);

Result<Message<kinship_wire_Announcement>> encode(const Announcement& announcement);
Result<Announcement> decode(const kinship_wire_Announcement& wire);

/// Its text is made one line, and texts that are too long are cut: every event is sent, also one
/// about an invalid name.
Result<Message<kinship_wire_Event>> encode(const Event& event);
Result<Event> decode(const kinship_wire_Event& wire);

}  // namespace kinship::codec
