#pragma once

#include <cstddef>
#include <set>
#include <span>
#include <string_view>

#include "proto/types/uuid.hpp"
#include "server/store/shared_report.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/tables/contents.hpp"

/// Reports as another store is told of them, see Store.
namespace kinship::store {

/// Those that cannot be read are left out. \throws Failure(InvalidInput) for a cursor of something
/// else.
Feed<ArrivedReport> page_of_arrivals(Database& database, std::string_view task,
                                     std::string_view cursor, std::size_t limit);

std::set<Uuid> select_known(Database& database, std::span<const Uuid> reports);

SharedRead select_shared(Database& database, std::span<const Uuid> reports, std::size_t max_bytes);

}  // namespace kinship::store
