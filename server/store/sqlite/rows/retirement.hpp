#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/result.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/replicated_report.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/retirement.hpp"

/// Retirement of paths by administrators, with entries in the audit log; without `audit` no entry.
/// The rows stay, outside the indexes that fits read. The list of reports with retired paths only
/// grows, and is sent to other stores.
namespace kinship::store {

/// Whether the path of a report is retired, from any client or store that sends it.
bool is_report_retired(Database& database, const Uuid& report_uuid);

/// Notes that a report has the content of an existing path.
void note_same_content(Database& database, std::int64_t path_id, const Uuid& report_uuid);

/// A page of Store::list_retirements(). \throws Failure(InvalidInput) for a cursor of another list.
Feed<Uuid> page_of_retirements(Database& database, std::string_view cursor, std::size_t limit);

/// Retires the path of a report: its own, or the earlier one of the same content.
/// \return NotFound for an unknown report; InvalidInput for a report without a path.
Result<Retirement> retire_path(Batch& batch, const Uuid& report_uuid, const AuditEntry* audit);

/// Retires the paths of reports that another store retired. Unknown reports are noted, and their
/// paths retired on arrival. \return the newly retired paths, by task.
std::vector<Retirement> retire_reports(Batch& batch, std::span<const Uuid> reports);

/// Retires paths in a batch.
RetireSome retirement_in(Batch& batch);

}  // namespace kinship::store
