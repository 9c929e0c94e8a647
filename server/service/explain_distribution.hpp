#pragma once

#include <cstdint>

#include "proto/types/summaries.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// Of a distribution whose paths were retired.
inline constexpr const char* kNotServed =
    "paths that it may be made of were retired, it is not served any more";

/// Adds what the store lists without: placement and selection, and whether a distribution was made
/// of paths which are retired, so that it is in the store and not served.
/// \throws Failure(Storage)
void complete_summaries(const store::Store& store, std::vector<DistributionSummary>& distributions);

/// How a distribution stands to the experience of now, and when it is fitted next. Its mixture is
/// left out, and so is what was rehearsed.
/// \param now_ms  Unix time, UTC.
/// \throws Failure(Storage)
Explanation explain_distribution(const store::Store& store, Distribution distribution,
                                 std::int64_t now_ms);

}  // namespace kinship::service
