#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "proto/types/summaries.hpp"
#include "server/store/session.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// The task's internal id; makes the task if it is missing.
std::int64_t ensure_task(Session& session, std::string_view task);

/// In order of names. Call it in a snapshot. \param cursor  the name of the last task shown.
Page<TaskSummary> page_of_tasks(Session& session, std::string_view cursor, std::size_t limit);

/// In a snapshot.
std::optional<TaskSummary> summary_of_task(Session& session, std::string_view task);

}  // namespace kinship::store
