#pragma once

#include <optional>

#include "proto/codec/message.hpp"
#include "proto/idl/register.h"

namespace kinship::codec {

/// The rule of the contract that a robot description breaks, if any. Its URDF is checked by
/// robots/kinematics.
std::optional<Error> validate(const RobotDescription& description);

Result<Message<kinship_wire_RegisterRequest>> encode(const Head& head,
                                                     const RobotDescription& description);
Result<RobotDescription> decode(const kinship_wire_RegisterRequest& wire);

Result<Message<kinship_wire_RegisterReply>> encode(const Head& head, const RegisterReply& reply);
Result<RegisterReply> decode(const kinship_wire_RegisterReply& wire);

}  // namespace kinship::codec
