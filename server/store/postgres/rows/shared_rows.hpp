#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/contents.hpp"

/// Reports as another store is told of them, see Store. A cursor is of the order in which
/// transactions began, and a feed ends before the first that is still open: several servers commit
/// at once, and nothing becomes visible behind a cursor that was given.
namespace kinship::store::postgres {

/// \throws Failure(InvalidInput) for a cursor of something else.
Feed<ArrivedReport> feed_of_arrivals(Connection& connection, std::string_view task,
                                     std::string_view cursor, std::size_t limit);
Feed<Uuid> feed_of_retirements(Connection& connection, std::string_view cursor, std::size_t limit);

std::set<Uuid> select_known(Connection& connection, std::span<const Uuid> reports);

/// All of it in one snapshot.
SharedRead select_shared(Connection& connection, std::span<const Uuid> reports,
                         std::size_t max_bytes);

/// Asked by whoever writes reports, before it looks which of them are retired and before it locks
/// anything else: until its commit nobody retires reports that are not there yet.
inline constexpr std::string_view kBeforeReports =
    "SELECT pg_advisory_xact_lock_shared(20261126) IS NULL";

/// In a writing transaction. Locks rows of `experience` in the order of the key.
std::vector<Retirement> retire_reports(Connection& connection, std::span<const Uuid> reports);

}  // namespace kinship::store::postgres
