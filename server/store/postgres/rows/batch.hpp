#pragma once

#include <cstdint>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/rules/batch_changes.hpp"
#include "server/store/rules/report_resolver.hpp"

namespace kinship::store::postgres {

/// Reads the state for the rules of reports, under locks that keep other servers from changing it
/// until the commit: first the robots, then the tasks' names, then the pairs, each in one order, so
/// that writers never deadlock. In a writing transaction.
/// \param max_paths  of a robot and task; 0: no cap.
/// \throws PostgresError of kind Conflict if a task of the batch was renamed meanwhile.
BatchState read_state(Connection& connection, PreparedAttempts attempts, std::uint64_t max_paths);

/// The checksum of a path's row once it is dropped.
std::uint32_t crc_when_dropped(Bytes report_uuid, Bytes T_task_base, std::int64_t dof,
                               std::int64_t waypoint_count);

/// Writes changes in one round trip, in the transaction whose locks covered their resolution.
/// \throws PostgresError of kind Conflict if another server wrote one of the reports meanwhile, for
///         another robot or task: then the caller must try the transaction again.
void write_changes(Connection& connection, const BatchChanges& changes, std::int64_t now_ms);

}  // namespace kinship::store::postgres
