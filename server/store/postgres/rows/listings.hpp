#pragma once

#include <optional>
#include <string_view>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/pages.hpp"

/// The pages of admin listings. A cursor is the sort key of the last row shown, so a page costs
/// the same wherever it is, and rows that come or go meanwhile neither repeat nor hide others.
/// Where ids fall, what other servers are committing while a listing is read may be missing in it,
/// as is what comes later; nothing that was there when its first page was read.
/// \throws Failure(InvalidInput) for a cursor of another listing.
namespace kinship::store::postgres {

/// Newest first; retired paths too.
Page<PathSummary> page_of_paths(Connection& connection, const PairFilter& filter,
                                std::string_view cursor, std::size_t limit);

/// The newest fit first. One that is fitted again meanwhile moves to the front.
Page<DistributionSummary> page_of_distributions(Connection& connection, const PairFilter& filter,
                                                std::string_view cursor, std::size_t limit);

/// Counts what a store holds, and what is damaged in it, from the small tables and from indexes:
/// cheap enough for once a second.
void count_rows(Connection& connection, StoreStatus& status);

}  // namespace kinship::store::postgres
