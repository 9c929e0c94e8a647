#pragma once

#include <cstddef>
#include <stop_token>

#include "proto/types/result.hpp"
#include "server/rehearsal/rehearsal_scheduler.hpp"
#include "server/rehearsal/rehearse.hpp"

namespace kinship::rehearsal {

/// What a rehearsal is about, out of the store: the robot, at most so many queries, ways, mixtures.
/// \return an error for people if the server does not know the robot, or no shape of it.
/// \throws Stopped; Failure(Storage)
Result<Subject> read_subject(const RehearsalKey& key, const RehearsalScheduler::Parts& parts,
                             std::size_t max_queries, const std::stop_token& stop);

}  // namespace kinship::rehearsal
