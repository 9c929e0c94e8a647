#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"
#include "server/store/values/experience_key.hpp"

/// One row per robot and task that somebody reported: its generations and its sums.
namespace kinship::store::postgres {

/// 0 if there is none.
std::uint64_t generation_of(Connection& connection, const Digest& robot, std::string_view task);

/// The robots that have, or had, paths of a task, by digest.
std::vector<ExperienceSummary> experience_of(Connection& connection, std::string_view task);

AttemptTotals totals_of(Connection& connection, const Digest& robot, std::string_view task);

/// Locks the rows of a robot, or of a task, in the order of the key.
std::vector<ExperienceKey> lock_pairs_of_robot(Connection& connection, std::int64_t robot_id);
std::vector<ExperienceKey> lock_pairs_of_task(Connection& connection, std::int64_t task_id);
void lock_pair(Connection& connection, const ExperienceKey& key);

/// What a retirement does to a locked row: both generations rise.
/// \param paths  that were counted until now.
void note_retirement(Connection& connection, const ExperienceKey& key, std::int64_t paths);

}  // namespace kinship::store::postgres
