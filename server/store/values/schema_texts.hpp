#pragma once

#include <cstdint>
#include <string>

/// Why a store of another schema is refused, and what can be done.
namespace kinship::store {

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
