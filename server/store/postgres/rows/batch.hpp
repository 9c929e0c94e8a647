#pragma once

#include <cstdint>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/rules/batch_changes.hpp"
#include "server/store/rules/report_resolver.hpp"

namespace kinship::store::postgres {

/// Reads what the rules of reports ask for, under locks that keep others from changing it until the
/// batch is committed: first the robots, then the pairs, each in the order of ids, so that writers
/// wait for each other in turn and never in a circle. In a writing transaction.
/// \param max_paths  of a robot and task; 0: no cap.
BatchState read_state(Connection& connection, PreparedAttempts attempts, std::uint64_t max_paths);

/// What the checksum of a path will be once it is dropped.
std::uint32_t crc_when_dropped(Bytes report_uuid, Bytes T_task_base, std::int64_t dof,
                               std::int64_t waypoint_count);

/// Writes changes in one round trip, in the transaction under whose locks they were resolved.
/// \throws PostgresError of kind Conflict if another server wrote one of its reports meanwhile, for
///         another robot or task: then the transaction is to be tried again.
void write_changes(Connection& connection, const BatchChanges& changes, std::int64_t now_ms);

}  // namespace kinship::store::postgres
