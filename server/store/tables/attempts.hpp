#pragma once

#include <cstddef>
#include <string_view>

#include "server/store/session.hpp"
#include "server/store/store.hpp"

/// Listings of attempts with what their search records say.
namespace kinship::store {

/// As ExperienceStore::find_attempts() says. Unreadable attempts, and those of removed robots, are
/// left out. Call it in a snapshot.
Page<AttemptSummary> page_of_found_attempts(Session& session, const WantedAttempts& wanted,
                                            std::string_view cursor, std::size_t limit);

}  // namespace kinship::store
