#include "server/store/sqlite/rows/set_aside_rows.hpp"

#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store {
namespace {

std::int64_t kind_code(AsideKind kind) { return static_cast<std::int64_t>(kind); }

}  // namespace

std::optional<Aside> find_aside(Database& database, AsideKind kind, std::int64_t id) {
  const auto query = database.cached(
      "SELECT replaced_by, retired_ms IS NOT NULL FROM set_aside WHERE kind = ? AND id = ? AND " +
      database.is_intact("set_aside"));
  if (!query->bind_all(kind_code(kind), id).step())
    return std::nullopt;
  Aside aside;
  if (!query->column_is_null(0))
    aside.replaced_by = query->column_integer(0);
  aside.retired = query->column_integer(1) != 0;
  return aside;
}

std::optional<std::int64_t> row_in_use(Database& database, AsideKind kind, std::int64_t id) {
  // A row is replaced by one that came later, so the ids grow and this ends.
  for (std::optional<std::int64_t> row = id; row;) {
    const std::optional<Aside> aside = find_aside(database, kind, *row);
    if (!aside)
      return row;
    if (aside->replaced_by && *aside->replaced_by <= *row)
      break;
    row = aside->replaced_by;
  }
  return std::nullopt;
}

void put_aside(Database& database, AsideKind kind, std::int64_t id,
               std::optional<std::int64_t> replaced_by) {
  database
      .cached(
          "INSERT INTO set_aside (kind, id, noticed_ms, replaced_by, reason)"
          " VALUES (?, ?, ?, ?, 'checksum') ON CONFLICT (kind, id) DO UPDATE"
          " SET replaced_by = coalesce(excluded.replaced_by, replaced_by)")
      ->bind_all(kind_code(kind), id, now_ms(), replaced_by)
      .run();
}

void retire_aside(Database& database, std::int64_t path_id) {
  database.cached("UPDATE set_aside SET retired_ms = ? WHERE kind = ? AND id = ?")
      ->bind_all(now_ms(), kind_code(AsideKind::Path), path_id)
      .run();
}

bool has_orphans(Database& database) {
  const auto query = database.cached("SELECT 1 FROM set_aside WHERE kind = ? LIMIT 1");
  return query->bind(1, kind_code(AsideKind::Orphan)).step();
}

std::vector<AsideCount> count_aside(Database& database) {
  const auto query = database.cached(
      "SELECT kind, count(*) FROM set_aside WHERE replaced_by IS NULL GROUP BY kind");
  std::vector<AsideCount> counts;
  while (query->step())
    counts.push_back({static_cast<AsideKind>(query->column_integer(0)), count_of(*query, 1)});
  return counts;
}

std::string_view name_of(AsideKind kind, std::uint64_t count) {
  const bool one = count == 1;
  switch (kind) {
    case AsideKind::Path:
      return one ? "path" : "paths";
    case AsideKind::Attempt:
      return one ? "attempt" : "attempts";
    case AsideKind::Scene:
      return one ? "scene" : "scenes";
    case AsideKind::Distribution:
      return one ? "distribution" : "distributions";
    case AsideKind::Orphan:
      return one ? "attempt" : "attempts";
  }
  return "rows";
}

}  // namespace kinship::store
