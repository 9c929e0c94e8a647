#pragma once

#include "server/store/postgres/database/connection.hpp"
#include "server/store/postgres/rows/batch_plan.hpp"

namespace kinship::store::postgres {

/// Writes a plan in one round trip, in the transaction under whose locks it was made.
/// \throws PostgresError of kind Conflict if another server wrote one of its reports meanwhile, for
///         another robot or task: then the transaction is to be tried again.
void write_plan(Connection& connection, const BatchPlan& plan, std::int64_t now_ms);

}  // namespace kinship::store::postgres
