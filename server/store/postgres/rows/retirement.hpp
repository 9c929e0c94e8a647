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

/// Paths that people take out of every fit, and the entries of the audit log that say so, in the
/// caller's writing transaction. Without `audit` none is kept.
namespace kinship::store::postgres {

/// As Store::retire_path() says.
Result<Retirement> retire_path(Connection& connection, const Uuid& report_uuid,
                               const AuditEntry* audit);

/// As Store::retire_reports() says. Locks rows of `experience` in the order of the key.
std::vector<Retirement> retire_reports(Connection& connection, std::span<const Uuid> reports);

/// Asked before reports are written, before it is looked which of them are retired and before
/// anything else is locked: until the commit no reports are retired that are not there yet.
inline constexpr std::string_view kBeforeReports =
    "SELECT pg_advisory_xact_lock_shared(20261126) IS NULL";

/// Retires paths in the caller's transaction. The reports that brought them, or were answered with
/// them, are remembered.
RetireSome retirement_in(Connection& connection);

/// Quarantines paths, and scenes until a report brings them anew under their ids. Paths are out of
/// the counts and of every reading, and the generation is raised; one that is quarantined already
/// stays so, one that is retired was out of the counts before. In a writing transaction.
void set_aside(Connection& connection, const DamagedRows& damaged);

}  // namespace kinship::store::postgres
