#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/result.hpp"
#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/contents.hpp"
#include "server/store/tables/retirement.hpp"

/// Retirement of paths by administrators, with entries in the audit log, in the caller's writing
/// transaction. Without `audit` no entry.
namespace kinship::store::postgres {

/// As Store::retire_path() says.
Result<Retirement> retire_path(Connection& connection, const Uuid& report_uuid,
                               const AuditEntry* audit);

/// As Store::retire_reports() says. Locks rows of `experience` in order of the key.
std::vector<Retirement> retire_reports(Connection& connection, std::span<const Uuid> reports);

/// To be run before reports are written, before the retired ones among them are read and before any
/// other lock: until the commit no unknown report can be retired.
inline constexpr std::string_view kBeforeReports =
    "SELECT pg_advisory_xact_lock_shared(20261126) IS NULL";

/// Retires paths in the caller's transaction. Their reports, also those answered Duplicate with
/// them, are noted as retired.
RetireSome retirement_in(Connection& connection);

/// Quarantines paths, and scenes until a report brings them again under their ids. Takes paths out
/// of the counts and of every reading, and raises the generation; a quarantined path stays so, a
/// retired one was out of the counts before. In a writing transaction.
void quarantine(Connection& connection, const DamagedRows& damaged);

}  // namespace kinship::store::postgres
