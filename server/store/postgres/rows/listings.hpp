#pragma once

#include <optional>
#include <string_view>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/pages.hpp"

/// The pages of admin listings. A cursor is the sort key of the last row shown, so every page costs
/// the same, and rows added or removed meanwhile neither repeat nor hide others. A listing by
/// falling ids may lack rows that other servers commit while it is read, but no row that existed
/// when its first page was read.
/// \throws Failure(InvalidInput) for a cursor of another listing.
namespace kinship::store::postgres {

/// Newest first; retired paths too.
Page<PathSummary> page_of_paths(Connection& connection, const PairFilter& filter,
                                std::string_view cursor, std::size_t limit);

/// The newest fit first. A distribution fitted again meanwhile moves to the front.
Page<DistributionSummary> page_of_distributions(Connection& connection, const PairFilter& filter,
                                                std::string_view cursor, std::size_t limit);

/// Counts a store's rows and damaged rows, from small tables and indexes: cheap enough for once a
/// second.
void count_rows(Connection& connection, StoreStatus& status);

}  // namespace kinship::store::postgres
