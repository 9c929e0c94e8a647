#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "proto/types/attempt.hpp"
#include "server/store/rules/batch_changes.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/pages.hpp"

/// One row per robot and task with reported attempts: its generations and its sums.
namespace kinship::store {

/// Makes the row of a robot and task unless it exists. \return number of paths in use.
std::uint64_t ensure_experience(Database& database, const ExperienceKey& key);

/// Adds all but the generation, which the batch raises.
void add_to_experience(Database& database, const ExperienceKey& key, const PairChange& change);

/// Takes paths out of the count.
void uncount_paths(Database& database, const ExperienceKey& key, std::int64_t paths);

/// The rows that a filter selects, in order of task and robot.
std::vector<ExperienceKey> select_experience(Database& database, const PairFilter& filter);

}  // namespace kinship::store
