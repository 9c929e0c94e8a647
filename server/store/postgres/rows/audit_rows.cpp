#include "server/store/postgres/rows/audit_rows.hpp"

#include <optional>
#include <string>

#include "server/store/postgres/rows/distribution_rows.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/clock.hpp"

namespace kinship::store::postgres {

void insert_audit(Connection& connection, const AuditEntry& entry) {
  const AuditEntry written = cut_to_fit(entry);
  connection.query(
      "INSERT INTO audit (time_ms, name, role, client, is_local, verb, target, outcome, was,"
      " became, message) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)",
      now_ms(), written.name, written.role, written.client, std::int64_t{written.is_local},
      written.verb, written.target, static_cast<std::int64_t>(written.outcome) + 1, written.before,
      written.after, written.message);
}

bool evict_audited(Connection& connection, const Digest& id, const AuditEntry* audit) {
  std::string before;
  if (audit != nullptr)
    if (const auto known = select_distribution(connection, id).distribution)
      before = describe_distribution(*known);
  if (!delete_distribution(connection, id))
    return false;
  if (audit != nullptr)
    insert_audit(connection, entry_of_act(*audit, AuditOutcome::Done, std::move(before), "gone"));
  return true;
}

}  // namespace kinship::store::postgres
