#pragma once

#include <cstdint>
#include <string_view>

#include "proto/types/audit.hpp"
#include "proto/types/result.hpp"
#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"
#include "server/store/values/experience_key.hpp"

/// Paths that people take out of every fit, and the entries of the audit log that say so, in the
/// caller's writing transaction. Without `audit` none is kept.
namespace kinship::store::postgres {

/// As Store::retire_path() says.
Result<Retirement> retire_path(Connection& connection, const Uuid& report_uuid,
                               const AuditEntry* audit);

/// Which paths of a task are to be retired.
struct TaskReset {
  std::int64_t task_id = 0;
  std::int64_t last_path_id = 0;  ///< those that come later stay
};

/// \return NotFound for an unknown task.
Result<TaskReset> begin_reset(Connection& connection, std::string_view task,
                              const AuditEntry* audit);

/// Retires some of the paths of a reset, few enough that reports do not wait long for the locks,
/// and adds them to `retired`. \return whether paths are left; else the entry says Done.
bool continue_reset(Connection& connection, const TaskReset& reset, Retirement& retired,
                    const AuditEntry* audit);

/// The most paths that are retired in one transaction: each is written anew.
inline constexpr std::int64_t kPathsOfAStep = 500;

/// Retires paths of a pair that is locked, as many as `limit` at most. The reports that brought
/// them, or were answered with them, are remembered.
/// \return how many.
std::int64_t retire_some(Connection& connection, const ExperienceKey& key, std::int64_t last_id,
                         std::int64_t limit);

}  // namespace kinship::store::postgres
