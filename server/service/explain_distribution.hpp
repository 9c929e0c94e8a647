#pragma once

#include <cstdint>

#include "proto/types/summaries.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// Message for a distribution whose paths were retired.
inline constexpr const char* kNotServed =
    "paths that it may be made of were retired, it is not served any more";

/// Adds the fields that the store's listing lacks: placement and selection, and whether a
/// distribution was made of paths that are retired, so that the store has it but it is not served.
/// \throws Failure(Storage)
void complete_summaries(const store::Store& store, std::vector<DistributionSummary>& distributions);

/// Compares a distribution with the current experience, and says when it is fitted next. Without
/// its mixture and its rehearsal.
/// \param now_ms  Unix time, UTC.
/// \throws Failure(Storage)
Explanation explain_distribution(const store::Store& store, Distribution distribution,
                                 std::int64_t now_ms);

}  // namespace kinship::service
