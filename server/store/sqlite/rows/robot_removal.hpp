#pragma once

#include <cstdint>

#include "proto/types/audit.hpp"
#include "proto/types/result.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/store.hpp"

/// Robots that people take out. What they brought stays for the record, out of every reading.
namespace kinship::store {

/// Retires some of a robot's paths, few enough that the writer is soon free for reports, and adds
/// them to `removed`; once none is left, takes the robot out in the same transaction. Where it
/// takes several of them the first entry says Begun, the last Done.
/// \return whether it is out; NotFound if it is not registered.
Result<bool> continue_removal(Batch& batch, const Digest& robot, RemovedRobot& removed,
                              const AuditEntry* audit);

}  // namespace kinship::store
