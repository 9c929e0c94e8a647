#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// Settings that mark a move between two stores (server/store/moving), so that no server serves a
/// half-filled target or a source that was moved.
namespace kinship::store {

/// In the target: the source's name.
inline constexpr std::string_view kMovingFrom = "moving_from";
/// In the source: the target's name.
inline constexpr std::string_view kMovedTo = "moved_to";
/// In the target, once it is done: the source's epoch.
inline constexpr std::string_view kMovedFrom = "moved_from";

/// Keeps a server from opening a store with these settings.
/// \param name  of the store. \param moving_from, moved_to  empty: not set.
/// \throws Failure(Unavailable) that says how to proceed, if either is set.
void refuse_moving_store(const std::string& name, const std::string& moving_from,
                         const std::string& moved_to);

inline constexpr const char* kHowToCarryOver =
    "; serve it with the program that wrote it, 'kinship paths export' there and 'kinship paths "
    "import' into a new store";

/// "2; this binary knows up to 1; ...", after "has schema".
inline std::string newer_schema(std::int64_t version, std::int64_t newest) {
  return std::to_string(version) + "; this binary knows up to " + std::to_string(newest) +
         kHowToCarryOver;
}

/// After "was made by".
inline std::string another_migration(std::int64_t version) {
  return "another text of migration " + std::to_string(version) + " than this binary has" +
         kHowToCarryOver;
}

}  // namespace kinship::store
