#pragma once

#include "proto/codec/message.hpp"
#include "proto/idl/admin.h"

namespace kinship::codec {

Result<Message<kinship_wire_AdminRequest>> encode(const Head& head, const AdminRequest& request);
Result<AdminRequest> decode(const kinship_wire_AdminRequest& wire);

/// \return TooLarge if the rows exceed kMaxPageBytes together.
Result<Message<kinship_wire_AdminReply>> encode(const Head& head, const AdminReply& reply);
Result<AdminReply> decode(const kinship_wire_AdminReply& wire);

}  // namespace kinship::codec
