#pragma once

#include <cstdint>

#include "proto/types/digest.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"

/// Which paths a robot and task keep when there may be no more than a cap: those with the smallest
/// content digests. Digests of distinct paths are as good as drawn at random, so these are a random
/// sample without replacement of all that were reported (bottom-k: Cohen and Kaplan, 2007), and the
/// same one in whatever order, and to whichever server, they were reported.
namespace kinship::store {

/// Whether a path that is not there yet is among those that are kept.
/// \param max_paths  of the robot and task; 0: no cap.
bool is_within_cap(Database& database, const ExperienceKey& key, const Digest& content,
                   std::uint64_t max_paths);

/// Drops paths beyond the cap, but not many at a time: after the cap was lowered the next reports
/// drop the others.
void drop_excess(Batch& batch, const ExperienceKey& key, std::uint64_t max_paths);

}  // namespace kinship::store
