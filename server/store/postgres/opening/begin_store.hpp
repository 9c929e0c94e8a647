#pragma once

#include <memory>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/postgres/opening/history.hpp"
#include "server/store/postgres/opening/primary.hpp"

namespace kinship::store::postgres {

/// The first connection of a store, which has today's schema then, and a run on it. Behind a pooler
/// a session may have statements of others by the names of ours: that is known from the first one
/// on, and none are kept then.
/// \throws PostgresError, Failure
std::unique_ptr<Connection> begin_store(Primary& primary, History& history);

}  // namespace kinship::store::postgres
