#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "proto/types/audit.hpp"
#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "server/runtime/clock.hpp"
#include "server/service/admin_page.hpp"
#include "server/service/jobs.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// Who asks for what, as the audit log names it.
AuditEntry audit_entry(const Caller& caller, const AdminRequest& request);

/// Writes what the store does not write with a change of its own: what was not done, and what is no
/// change of the store. May be shared between threads.
class AuditTrail {
 public:
  /// Refusals are kept up to so many at once, and one a second from then on: whoever is refused may
  /// ask for ever, and nothing is ever taken out of the log. The next one kept counts the others.
  static constexpr std::uint64_t kRefusalsAtOnce = 100;

  /// \param store, clock  outlive the trail.
  AuditTrail(store::Store& store, const runtime::Clock& clock);

  /// Before something is done: what cannot be kept is not done.
  /// \throws Failure(Storage)
  void begin(AuditEntry entry, const std::string& before);
  /// After it was done. What cannot be kept now is in the log as begun.
  void end(AuditEntry entry, const std::string& before, const std::string& after) noexcept;
  /// Of something that was refused or failed, unless the page is Ok.
  void not_done(AuditEntry entry, const AdminPage& page) noexcept;

  /// The job's work with the entry of how it ended. \param run  of a job that `entry` began.
  std::function<bool(JobRun&)> ending(AuditEntry entry, std::function<bool(JobRun&)> run);

 private:
  void add(const AuditEntry& entry) noexcept;
  bool may_keep_refusal(std::uint64_t& left_out);

  store::Store& store_;
  const runtime::Clock& clock_;
  std::mutex mutex_;  // guards what follows
  std::uint64_t allowance_ = kRefusalsAtOnce;
  std::uint64_t left_out_ = 0;
  std::chrono::steady_clock::time_point counted_at_;
};

}  // namespace kinship::service
