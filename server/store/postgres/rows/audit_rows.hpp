#pragma once

#include "proto/types/audit.hpp"
#include "proto/types/digest.hpp"
#include "server/store/postgres/database/connection.hpp"

/// The audit log: rows are added, never changed (triggers of the schema see to it).
namespace kinship::store::postgres {

/// Adds an entry, of now; its number is given here. Texts are cut to what fits.
void insert_audit(Connection& connection, const AuditEntry& entry);

/// As delete_distribution(), with an entry in the same transaction; none if it was not there, or
/// without `audit`.
bool evict_audited(Connection& connection, const Digest& id, const AuditEntry* audit);

}  // namespace kinship::store::postgres
