#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/result.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/shared_report.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/retirement.hpp"

/// Paths that people take out of every fit, and the entries of the audit log that say so; without
/// `audit` none is kept. Their rows stay, out of the indexes that fits read. Which reports' paths
/// were retired is a list that only grows, and that other stores are told.
namespace kinship::store {

/// Whether the path of a report is retired wherever it comes from.
bool is_report_retired(Database& database, const Uuid& report_uuid);

/// Notes that the content of a report is that of a path which is there.
void note_same_content(Database& database, std::int64_t path_id, const Uuid& report_uuid);

/// A page of Store::list_retirements(). \throws Failure(InvalidInput) for a cursor of another list.
Feed<Uuid> page_of_retirements(Database& database, std::string_view cursor, std::size_t limit);

/// Retires the path of a report: the one it brought, or the earlier one of the same content.
/// \return NotFound for an unknown report; InvalidInput for one that brought no path.
Result<Retirement> retire_path(Batch& batch, const Uuid& report_uuid, const AuditEntry* audit);

/// Retires the paths of reports that another store retired. Those that are not here are
/// remembered, and retired when they come. \return by task, what was not retired before.
std::vector<Retirement> retire_reports(Batch& batch, std::span<const Uuid> reports);

/// Retires paths in a batch.
RetireSome retirement_in(Batch& batch);

}  // namespace kinship::store
