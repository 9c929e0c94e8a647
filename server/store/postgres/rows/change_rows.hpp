#pragma once

#include <string_view>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"

namespace kinship::store::postgres {

/// What was committed since a look; see Store::changes_since(). The cursor is a transaction id
/// below which nothing was under way then. Reads one state of the database: in a snapshot. \throws
/// Failure(InvalidInput) for a cursor that is none.
StoreChanges changes_since(Connection& connection, std::string_view cursor);

}  // namespace kinship::store::postgres
