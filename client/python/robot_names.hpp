#pragma once

#include "client/python/bindings.hpp"
#include "proto/types/attempt.hpp"

/// Robots named by Python arguments.
namespace kinship::python {

/// Sets the robot of an attempt by its digest or label.
void set_robot(json::NamedAttempt& attempt, const RobotName& robot);

/// The attempt as it can be sent.
/// \throws Failure(InvalidInput) if its robot is named by a label: its digest is not known here.
const Attempt& attempt_of(const json::NamedAttempt& named);

}  // namespace kinship::python
