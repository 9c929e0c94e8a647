#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"
#include "server/store/session.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// The condition that a row of table task is listed: intact, and not removed or with attempts that
/// came since.
std::string is_listed_task(Session& session);

/// The task's internal id; makes the task if it is missing.
std::int64_t ensure_task(Session& session, std::string_view task);

/// The internal id of a task that is listed.
/// \throws Failure(Storage) if its row is damaged.
std::optional<std::int64_t> find_task(Session& session, std::string_view task);

/// In order of names. Call it in a snapshot. \param cursor  the name of the last task shown.
Page<TaskSummary> page_of_tasks(Session& session, std::string_view cursor, std::size_t limit);

/// In a snapshot.
std::optional<TaskSummary> summary_of_task(Session& session, std::string_view task);

/// As ExperienceStore::task_names().
std::vector<std::string> select_task_names(Session& session, const WantedNames& wanted);

/// As AdminStore::rename_task(), in the caller's transaction.
Result<std::vector<Digest>> rename_task(Session& session, std::string_view task,
                                        std::string_view name, const AuditEntry* audit);

/// All attempts, also of removed robots.
std::uint64_t attempts_of_task(Session& session, std::int64_t task_id);

/// The last transaction of a removal, after the reset.
/// \param removal  with the number of attempts beyond which the task is listed again.
RemovedTask end_task_removal(Session& session, std::int64_t task_id, TaskRemoval removal,
                             const AuditEntry* audit);

}  // namespace kinship::store
