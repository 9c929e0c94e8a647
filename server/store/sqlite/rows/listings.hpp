#pragma once

#include <cstddef>
#include <string_view>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/pages.hpp"

/// The pages of admin listings. A cursor is the sort key of the last row shown, so every page costs
/// the same, and rows added or removed meanwhile neither repeat nor hide others.
/// \throws Failure(InvalidInput) for a cursor of another listing.
namespace kinship::store {

/// Newest first; retired paths too.
Page<PathSummary> page_of_paths(Database& database, const PairFilter& filter,
                                std::string_view cursor, std::size_t limit);

/// The newest fit first. A distribution fitted again meanwhile moves to the front.
Page<DistributionSummary> page_of_distributions(Database& database, const PairFilter& filter,
                                                std::string_view cursor, std::size_t limit);

/// Fills the counts, the schema version and the size; adds the quarantined rows to the message.
void count_rows(Database& database, StoreStatus& status);

}  // namespace kinship::store
