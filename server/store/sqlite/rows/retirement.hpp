#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/result.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/store.hpp"

/// Paths that people take out of every fit, and the entries of the audit log that say so; without
/// `audit` none is kept. Their rows stay, out of the indexes that fits read.
namespace kinship::store {

/// Retires the path of a report: the one it brought, or the earlier one of the same content.
/// \return NotFound for an unknown report; InvalidInput for one that brought no path.
Result<Retirement> retire_path(Batch& batch, const Uuid& report_uuid, const AuditEntry* audit);

/// Retires the paths of reports that another store retired. Those that are not here are
/// remembered, and retired when they come. \return by task, what was not retired before.
std::vector<Retirement> retire_reports(Batch& batch, std::span<const Uuid> reports);

/// Which paths of a task are to be retired.
struct TaskReset {
  std::int64_t task_id = 0;
  std::int64_t last_path_id = 0;  ///< those that come later stay
};

/// \return NotFound for an unknown task.
Result<TaskReset> begin_reset(Database& database, std::string_view task, const AuditEntry* audit);

/// Retires some of the paths of a reset, few enough that the writer is soon free for reports, and
/// adds them to `retired`. \return whether paths are left; else the entry says Done.
bool continue_reset(Batch& batch, const TaskReset& reset, Retirement& retired,
                    const AuditEntry* audit);

/// The most paths that are retired in one transaction: each is written anew.
inline constexpr std::int64_t kPathsOfAStep = 500;

/// Retires paths of a robot and task, as many as `limit` at most, and adds them to `retired`.
/// \return how many.
std::int64_t retire_some(Batch& batch, const ExperienceKey& key, std::int64_t limit,
                         Retirement& retired);

}  // namespace kinship::store
