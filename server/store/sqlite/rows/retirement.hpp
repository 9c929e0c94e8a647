#pragma once

#include <span>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/result.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/retirement.hpp"

/// Paths that people take out of every fit, and the entries of the audit log that say so; without
/// `audit` none is kept. Their rows stay, out of the indexes that fits read.
namespace kinship::store {

/// Retires the path of a report: the one it brought, or the earlier one of the same content.
/// \return NotFound for an unknown report; InvalidInput for one that brought no path.
Result<Retirement> retire_path(Batch& batch, const Uuid& report_uuid, const AuditEntry* audit);

/// Retires the paths of reports that another store retired. Those that are not here are
/// remembered, and retired when they come. \return by task, what was not retired before.
std::vector<Retirement> retire_reports(Batch& batch, std::span<const Uuid> reports);

/// Retires paths in a batch.
RetireSome retirement_in(Batch& batch);

}  // namespace kinship::store
