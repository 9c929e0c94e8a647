#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "server/store/session.hpp"
#include "server/store/store.hpp"
#include "server/store/values/experience_key.hpp"

/// One row per robot and task with reported attempts: its generations and its sums.
namespace kinship::store {

/// 0 if there is none.
std::uint64_t generation_of(Session& session, const Digest& robot, std::string_view task);

/// The robots that have, or had, paths of a task, by digest.
std::vector<ExperienceSummary> experience_of(Session& session, std::string_view task);

/// Locks the rows of a robot, or of a task, in order of the key, until the transaction ends.
std::vector<ExperienceKey> lock_pairs_of_robot(Session& session, std::int64_t robot_id);
std::vector<ExperienceKey> lock_pairs_of_task(Session& session, std::int64_t task_id);

/// In a snapshot.
AttemptTotals totals_of(Session& session, const Digest& robot, std::string_view task);

}  // namespace kinship::store
