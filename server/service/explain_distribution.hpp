#pragma once

#include <cstdint>

#include "proto/types/summaries.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// How a distribution stands to the experience of now, and when it is fitted next. Its mixture is
/// left out, and so is what was rehearsed.
/// \param now_ms  Unix time, UTC.
/// \throws Failure(Storage)
Explanation explain_distribution(const store::Store& store, Distribution distribution,
                                 std::int64_t now_ms);

}  // namespace kinship::service
