#pragma once

#include <cstdint>
#include <string_view>

#include "server/store/session.hpp"

namespace kinship::store {

/// The task's internal id; makes the task if it is missing.
std::int64_t ensure_task(Session& session, std::string_view task);

}  // namespace kinship::store
