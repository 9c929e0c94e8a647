#pragma once

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"

namespace kinship::store::postgres {

/// Counts what a store holds, and what is damaged in it, from the small tables and from indexes:
/// cheap enough for once a second.
void count_rows(Connection& connection, StoreStatus& status);

}  // namespace kinship::store::postgres
