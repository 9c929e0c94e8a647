#pragma once

#include "client/python/bindings.hpp"
#include "proto/types/attempt.hpp"

/// Which robot is meant by what Python says.
namespace kinship::python {

/// Has an attempt name a robot by its digest, or by a label.
void set_robot(json::NamedAttempt& attempt, const RobotName& robot);

/// The attempt as it can be sent.
/// \throws Failure(InvalidInput) if its robot is named by a label: nobody here knows its digest.
const Attempt& attempt_of(const json::NamedAttempt& named);

}  // namespace kinship::python
