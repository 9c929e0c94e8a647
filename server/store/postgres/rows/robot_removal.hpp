#pragma once

#include "proto/types/audit.hpp"
#include "proto/types/result.hpp"
#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"

/// Robots that people take out. What they brought stays for the record, out of every reading.
namespace kinship::store::postgres {

/// Retires some of a robot's paths, few enough that reports do not wait long, and adds them to
/// `removed`; once none is left, takes the robot out. In a writing transaction. Where it takes
/// several of them the first entry says Begun, the last Done.
/// \return whether it is out; NotFound if it is not registered.
Result<bool> continue_removal(Connection& connection, const Digest& robot, RemovedRobot& removed,
                              const AuditEntry* audit);

}  // namespace kinship::store::postgres
