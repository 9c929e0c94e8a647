#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "server/store/sqlite/database/database.hpp"

/// The quarantine: ids of damaged rows, which themselves may be neither readable nor writable.
namespace kinship::store {

/// The codes are part of the schema.
enum class AsideKind : std::uint8_t {
  Path = 1,
  Attempt = 2,
  Scene = 3,
  Distribution = 4,
  Orphan = 5  ///< a path in use, or retired, that lost its attempt in a repair
};

/// A quarantined row.
struct Aside {
  std::optional<std::int64_t> replaced_by;  ///< brought by a later report
  bool retired = false;                     ///< a path
};

/// Nothing if the row is in use.
std::optional<Aside> find_aside(Database& database, AsideKind kind, std::int64_t id);

/// The row to use for this one: itself, its replacement, or nothing while it is quarantined.
std::optional<std::int64_t> row_in_use(Database& database, AsideKind kind, std::int64_t id);

/// Quarantines a row, or notes the replacement of a quarantined one.
void put_aside(Database& database, AsideKind kind, std::int64_t id,
               std::optional<std::int64_t> replaced_by = std::nullopt);

/// Retires a quarantined path.
void retire_aside(Database& database, std::int64_t path_id);

/// Whether a repair left paths without their attempts.
bool has_orphans(Database& database);

/// Number of quarantined rows of a kind that were not replaced.
struct AsideCount {
  AsideKind kind{};
  std::uint64_t rows = 0;
};
std::vector<AsideCount> count_aside(Database& database);

/// The name of a kind of row, singular or plural.
std::string_view name_of(AsideKind kind, std::uint64_t count);

}  // namespace kinship::store
