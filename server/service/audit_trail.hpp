#pragma once

#include <functional>
#include <string>

#include "proto/types/audit.hpp"
#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "server/runtime/clock.hpp"
#include "server/service/admin_page.hpp"
#include "server/service/audit_rate_limit.hpp"
#include "server/store/admin_store.hpp"

namespace kinship::service {

/// The caller and the request as an entry of the audit log.
AuditEntry audit_entry(const Caller& caller, const AdminRequest& request);

/// Writes the audit entries that the store does not write together with a change: refusals,
/// failures, and actions that do not change the store. May be shared between threads.
class AuditTrail {
 public:
  /// \param store, clock  outlive the trail.
  AuditTrail(store::AdminStore& store, const runtime::Clock& clock)
      : store_(store), allowance_(clock) {}

  /// Call before an action: an action that cannot be logged is not taken.
  /// \throws Failure(Storage)
  void begin(AuditEntry entry, const std::string& before);
  /// Call before data is handed out, which changes nothing: logged as Done.
  /// \throws Failure(Storage)
  void hand_out(AuditEntry entry, const std::string& what);
  /// Call after an action. If the entry cannot be written, the log has the action as begun.
  void end(AuditEntry entry, const std::string& before, const std::string& after) noexcept;
  /// Logs a refused or failed request; does nothing if the page is Ok. Limited per client
  /// (AuditRateLimit), except for the end of an action that is in the log as begun. The next entry
  /// written has the number of those left out.
  void not_done(AuditEntry entry, const AdminPage& page) noexcept;

  /// A function that logs the end of a job that `entry` began; the trail outlives it.
  std::function<void(const Job&)> ending(AuditEntry entry);

 private:
  void add(const AuditEntry& entry) noexcept;

  store::AdminStore& store_;
  AuditRateLimit allowance_;
};

}  // namespace kinship::service
