#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/contents.hpp"
#include "server/store/tables/pages.hpp"

/// Whole attempts, with their paths and scenes. All of it reads one snapshot.
namespace kinship::store::postgres {

/// As Store::list_attempts() says.
Page<AttemptSummary> page_of_attempts(Connection& connection, const PairFilter& filter,
                                      std::string_view cursor, std::size_t limit);

/// As Store::find_attempt() says.
std::optional<Attempt> find_attempt(Connection& connection, const Uuid& report_uuid,
                                    DamagedRows& noticed);

/// As Store::export_attempts() says. An export has every attempt acknowledged before its last page
/// was read; see ArrivalPage.
Page<Attempt> export_page(Connection& connection, const PairFilter& filter, std::string_view cursor,
                          std::size_t limit, std::size_t max_bytes, DamagedRows& noticed);

/// As Store::read_reports() says.
ReplicatedRead select_replicated(Connection& connection, std::span<const Uuid> reports,
                                 std::size_t max_bytes);

}  // namespace kinship::store::postgres
