#pragma once

#include <map>
#include <span>
#include <string_view>

#include "proto/types/result.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/contents.hpp"
#include "server/store/tables/pages.hpp"

namespace kinship::store {

/// Attempts with their paths and scenes, and the damaged rows found.
struct ExportRead {
  Page<Attempt> page;
  DamagedRows damaged;
};

/// A page of Store::export_attempts(). The cursor is the id of the last attempt looked at.
/// \throws Failure(InvalidInput) for a cursor of another listing.
ExportRead export_page(Database& database, const PairFilter& filter, std::string_view cursor,
                       std::size_t limit, std::size_t max_bytes);

/// A page of Store::list_attempts(), with a cursor of the same kind. Unreadable attempts are left
/// out.
/// \throws Failure(InvalidInput) for a cursor of another listing.
Page<AttemptSummary> page_of_attempts(Database& database, const PairFilter& filter,
                                      std::string_view cursor, std::size_t limit);

/// An attempt with its path and scene, if they can be read.
/// \return NotFound if it is not known; Storage if its row is damaged.
Result<Attempt> find_attempt(Database& database, const Uuid& report_uuid, DamagedRows& noted);

/// Reports for another store, see Store::list_arrivals(). Unreadable ones are left out.
/// \throws Failure(InvalidInput) for a cursor of another list.
Feed<ArrivedReport> page_of_arrivals(Database& database, std::string_view task,
                                     std::string_view cursor, std::size_t limit);
std::map<Uuid, Digest> select_known(Database& database, std::span<const Uuid> reports);
ReplicatedRead select_replicated(Database& database, std::span<const Uuid> reports,
                                 std::size_t max_bytes);

}  // namespace kinship::store
