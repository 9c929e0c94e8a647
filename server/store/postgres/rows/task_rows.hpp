#pragma once

#include <cstdint>
#include <string_view>

#include "server/store/postgres/database/connection.hpp"

namespace kinship::store::postgres {

/// The task's internal id; makes the task if it is missing. In a writing transaction.
std::int64_t ensure_task(Connection& connection, std::string_view task);

}  // namespace kinship::store::postgres
