#include "server/service/audit_trail.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "proto/types/enum_text.hpp"
#include "server/access/verb_rules.hpp"

namespace kinship::service {

AuditEntry audit_entry(const Caller& caller, const AdminRequest& request) {
  AuditEntry entry;
  entry.name = caller.name;
  if (!caller.name.empty())
    entry.role = to_text(caller.role);
  entry.client = caller.client;
  entry.is_local = caller.is_local;
  entry.verb = access::rule_of(request.verb).name;
  entry.target = request.verb == AdminVerb::RenameRobot ? request.robot + " to " + request.argument
                                                        : request.argument;
  return entry;
}

AuditTrail::AuditTrail(store::Store& store, const runtime::Clock& clock)
    : store_(store), clock_(clock), counted_at_(clock.now()) {}

void AuditTrail::begin(AuditEntry entry, const std::string& before) {
  entry.outcome = AuditOutcome::Begun;
  entry.before = before;
  store_.add_audit(entry);
}

void AuditTrail::end(AuditEntry entry, const std::string& before,
                     const std::string& after) noexcept {
  entry.outcome = AuditOutcome::Done;
  entry.before = before;
  entry.after = after;
  add(entry);
}

void AuditTrail::not_done(AuditEntry entry, const AdminPage& page) noexcept {
  if (page.status == AdminStatus::Ok)
    return;
  const bool has_failed = page.status == AdminStatus::Failed;
  entry.outcome = has_failed ? AuditOutcome::Failed : AuditOutcome::Refused;
  entry.message = page.message;
  std::uint64_t left_out = 0;
  if (!has_failed && !may_keep_refusal(left_out))
    return;
  if (left_out > 0)
    entry.message += " (" + std::to_string(left_out) + " refusals before it were not kept)";
  add(entry);
}

std::function<bool(JobRun&)> AuditTrail::ending(AuditEntry entry,
                                                std::function<bool(JobRun&)> run) {
  return [this, entry = std::move(entry), run = std::move(run)](JobRun& job) {
    AuditEntry last = entry;
    last.outcome = AuditOutcome::Failed;
    try {
      const bool is_complete = run(job);
      last.outcome = is_complete ? AuditOutcome::Done : AuditOutcome::Failed;
      last.after = is_complete ? job.message : "";
      last.message = is_complete ? "" : "cancelled";
    } catch (const std::exception& exception) {
      last.message = exception.what();
      add(last);
      throw;
    }
    add(last);
    return last.outcome == AuditOutcome::Done;
  };
}

/// What is not durable is told by the store's own trouble; the act itself cannot be undone.
void AuditTrail::add(const AuditEntry& entry) noexcept {
  try {
    store_.add_audit(entry);
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): see above
  }
}

bool AuditTrail::may_keep_refusal(std::uint64_t& left_out) {
  const std::lock_guard lock(mutex_);
  const auto now = clock_.now();
  const auto passed = std::chrono::duration_cast<std::chrono::seconds>(now - counted_at_);
  if (passed.count() > 0) {
    allowance_ = std::min<std::uint64_t>(kRefusalsAtOnce,
                                         allowance_ + static_cast<std::uint64_t>(passed.count()));
    counted_at_ += passed;
  }
  if (allowance_ == 0) {
    ++left_out_;
    return false;
  }
  --allowance_;
  left_out = std::exchange(left_out_, 0);
  return true;
}

}  // namespace kinship::service
