#pragma once

#include <functional>
#include <string>

#include "proto/types/audit.hpp"
#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "server/runtime/clock.hpp"
#include "server/service/admin_page.hpp"
#include "server/service/audit_rate_limit.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// Who asks for what, as the audit log names it.
AuditEntry audit_entry(const Caller& caller, const AdminRequest& request);

/// Writes what the store does not write with a change of its own: what was not done, and what is no
/// change of the store. May be shared between threads.
class AuditTrail {
 public:
  /// \param store, clock  outlive the trail.
  AuditTrail(store::Store& store, const runtime::Clock& clock) : store_(store), allowance_(clock) {}

  /// Before something is done: what cannot be kept is not done.
  /// \throws Failure(Storage)
  void begin(AuditEntry entry, const std::string& before);
  /// Before something is handed out that is no change: as Done. \throws Failure(Storage)
  void hand_out(AuditEntry entry, const std::string& what);
  /// After it was done. What cannot be kept now is in the log as begun.
  void end(AuditEntry entry, const std::string& before, const std::string& after) noexcept;
  /// Of something that was refused or failed, unless the page is Ok; of one client so many
  /// (AuditRateLimit), but for the end of what is in the log as begun. The next one kept counts the
  /// others.
  void not_done(AuditEntry entry, const AdminPage& page) noexcept;

  /// Keeps how a job ended that `entry` began; the trail outlives it.
  std::function<void(const Job&)> ending(AuditEntry entry);

 private:
  void add(const AuditEntry& entry) noexcept;

  store::Store& store_;
  AuditRateLimit allowance_;
};

}  // namespace kinship::service
