#pragma once

#include <string>
#include <string_view>

/// Settings of a store that is moved to another one (server/store/moving), so that no server takes
/// half a store for a whole one, or serves one that was left.
namespace kinship::store {

inline constexpr std::string_view kMovingFrom = "moving_from";  ///< here: what it is filled from
inline constexpr std::string_view kMovedTo = "moved_to";        ///< where its content is now

/// What a server does that opens a store with these settings.
/// \param name  of the store. \param moving_from, moved_to  empty: not there.
/// \throws Failure(Unavailable) that says what to do, if either is there.
void refuse_moving_store(const std::string& name, const std::string& moving_from,
                         const std::string& moved_to);

}  // namespace kinship::store
