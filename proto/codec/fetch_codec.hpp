#pragma once

#include <optional>

#include "proto/codec/message.hpp"
#include "proto/idl/fetch.h"

namespace kinship::codec {

/// The rule of the contract that a request, a distribution, an experience or a rehearsal breaks, if
/// any.
std::optional<Error> validate(const FetchRequest& request);
std::optional<Error> validate(const Distribution& distribution);
std::optional<Error> validate(const TaskExperience& experience);
std::optional<Error> validate(const Rehearsal& rehearsal);

Result<Message<kinship_wire_FetchRequest>> encode(const Head& head, const FetchRequest& request);
Result<FetchRequest> decode(const kinship_wire_FetchRequest& wire);

/// \return TooLarge for a mixture, with an experience and a library, that does not fit into a
/// sample.
Result<Message<kinship_wire_FetchReply>> encode(const Head& head, const FetchReply& reply);
Result<FetchReply> decode(const kinship_wire_FetchReply& wire);

}  // namespace kinship::codec
