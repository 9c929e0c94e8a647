#include "server/service/audit_trail.hpp"

#include <algorithm>
#include <new>
#include <optional>
#include <utility>

#include "proto/types/enum_text.hpp"

namespace kinship::service {
namespace {

/// Verbs of which the store has an entry, as begun, before they fail.
bool is_begun_first(const AuditEntry& entry) {
  return std::ranges::any_of(kVerbRules, [&](const VerbRule& rule) {
    return rule.name == entry.verb && rule.is(VerbRule::Long);
  });
}

/// A caller without a certificate, and how the server knows where it is: "..., this machine, by
/// packet address 127.0.0.1", "..., address 10.0.0.7, token shown".
std::string client_text(const Caller& caller) {
  if (!caller.name.empty() || (caller.address.empty() && !caller.is_local))
    return caller.client;
  const std::string place =
      caller.address.empty()
          ? "the server's own process"
          : (caller.is_local ? "this machine, by packet address " : "address ") + caller.address;
  return caller.client + ", " + place + (caller.token == TokenProof::Shown ? ", token shown" : "");
}

std::string target_of(const AdminRequest& request) {
  if (request.verb == AdminVerb::RenameRobot)
    return request.robot + " to " + request.argument;
  if (request.verb == AdminVerb::RenameTask)
    return request.task + " to " + request.argument;
  if (request.argument.empty())  // of RestorePath: the filters
    return request.task + (request.robot.empty() ? "" : " of " + request.robot);
  return request.argument;
}

}  // namespace

AuditEntry audit_entry(const Caller& caller, const AdminRequest& request) {
  AuditEntry entry;
  entry.name = caller.name;
  if (!caller.name.empty())
    entry.role = to_text(caller.role);
  entry.client = client_text(caller);
  entry.is_local = caller.is_local;
  entry.verb = rule_of(request.verb).name;
  entry.target = target_of(request);
  return entry;
}

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

void AuditTrail::hand_out(AuditEntry entry, const std::string& what) {
  entry.outcome = AuditOutcome::Done;
  entry.after = what;
  store_.add_audit(entry);
}

void AuditTrail::not_done(AuditEntry entry, const AdminPage& page) noexcept {
  if (page.status == AdminStatus::Ok)
    return;
  try {
    const bool has_failed = page.status == AdminStatus::Failed;
    entry.outcome = has_failed ? AuditOutcome::Failed : AuditOutcome::Refused;
    entry.message = page.message;
    if (!has_failed || !is_begun_first(entry)) {
      const std::optional<std::uint64_t> left_out = allowance_.take(entry.client);
      if (!left_out)
        return;
      if (*left_out > 0)
        entry.message += " (" + std::to_string(*left_out) + " of its own before it were not kept)";
    }
  } catch (const std::bad_alloc&) {  // then not: it was not done, either
    return;
  }
  add(entry);
}

std::function<void(const Job&)> AuditTrail::ending(AuditEntry entry) {
  return [this, entry = std::move(entry)](const Job& job) {
    AuditEntry last = entry;
    const bool is_done = job.state == JobState::Done;
    last.outcome = is_done ? AuditOutcome::Done : AuditOutcome::Failed;
    (is_done ? last.after : last.message) = job.message;
    add(last);
  };
}

/// The store's own trouble reports an entry that is not durable; the act itself cannot be undone.
void AuditTrail::add(const AuditEntry& entry) noexcept {
  try {
    store_.add_audit(entry);
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): see above
  }
}

}  // namespace kinship::service
