#pragma once

#include <cstdint>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/values/experience_key.hpp"

/// One row per robot and task that somebody reported: its generations and its sums.
namespace kinship::store::postgres {

/// Locks a row for the rest of the transaction.
void lock_pair(Connection& connection, const ExperienceKey& key);

/// What a retirement does to a locked row: both generations rise.
/// \param paths  that were counted until now.
void note_retirement(Connection& connection, const ExperienceKey& key, std::int64_t paths);

}  // namespace kinship::store::postgres
