#pragma once

#include <optional>

#include "proto/codec/message.hpp"
#include "proto/idl/admin.h"

namespace kinship::codec {

/// The rule of the contract that a request breaks, if any.
std::optional<Error> validate(const AdminRequest& request);

Result<Message<kinship_wire_AdminRequest>> encode(const Head& head, const AdminRequest& request);
Result<AdminRequest> decode(const kinship_wire_AdminRequest& wire);

/// \return TooLarge if the rows exceed kMaxPageBytes together.
Result<Message<kinship_wire_AdminReply>> encode(const Head& head, const AdminReply& reply);
Result<AdminReply> decode(const kinship_wire_AdminReply& wire);

}  // namespace kinship::codec
