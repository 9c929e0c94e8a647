#pragma once

#include <optional>

#include "proto/types/digest.hpp"
#include "proto/types/failure.hpp"
#include "server/store/robot_store.hpp"

namespace kinship::sites {

/// Registers a robot of one store at another one unless it is there. If another robot has its
/// label, the beginning of its digest is appended to the label: a label is a name at one site, the
/// digest identifies the robot.
/// \return why it cannot be registered; nothing on success.
/// \throws Failure of either store.
std::optional<Error> carry_robot(const store::RobotStore& from, store::RobotStore& to,
                                 const Digest& robot);

}  // namespace kinship::sites
