#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "server/store/sqlite/database/database.hpp"

/// What is damaged, by its id: the rows themselves may not be readable, let alone be written.
namespace kinship::store {

/// The codes are part of the schema.
enum class AsideKind : std::uint8_t {
  Path = 1,
  Attempt = 2,
  Scene = 3,
  Distribution = 4,
  Orphan = 5  ///< a path in use, or retired, that lost its attempt in a repair
};

/// One row that is set aside.
struct Aside {
  std::optional<std::int64_t> replaced_by;  ///< brought by a later report
  bool retired = false;                     ///< a path
};

/// Nothing if the row is in use.
std::optional<Aside> find_aside(Database& database, AsideKind kind, std::int64_t id);

/// The row that stands for this one: itself, what replaced it, or nothing while it is set aside.
std::optional<std::int64_t> row_in_use(Database& database, AsideKind kind, std::int64_t id);

/// Sets a row aside, or says of one that is aside already what replaces it.
void put_aside(Database& database, AsideKind kind, std::int64_t id,
               std::optional<std::int64_t> replaced_by = std::nullopt);

/// A path that is set aside is retired.
void retire_aside(Database& database, std::int64_t path_id);

/// Whether a repair left paths without their attempts.
bool has_orphans(Database& database);

/// How many of each kind are set aside and were not replaced.
struct AsideCount {
  AsideKind kind{};
  std::uint64_t rows = 0;
};
std::vector<AsideCount> count_aside(Database& database);

/// What a row of a kind is called, for one and for several.
std::string_view name_of(AsideKind kind, std::uint64_t count);

}  // namespace kinship::store
