#include "server/app/revocation_watch.hpp"

#include <charconv>
#include <exception>
#include <optional>
#include <utility>

#include "proto/security/credentials.hpp"
#include "proto/types/time_text.hpp"
#include "server/store/values/audit_texts.hpp"

namespace kinship::app {
namespace {

using security::Revocation;

// Acts in the audit log by the name that no client can have.
constexpr const char* kRevoke = "revoke";
constexpr const char* kReplace = "replace_credentials";
constexpr const char* kRevokeAgain = "revoke_again";

AuditEntry entry_of(const char* verb, const std::string& client, const std::string& after) {
  AuditEntry entry = store::entry_of_maintenance(verb, client, "", after);
  entry.name = security::kServerName;
  return entry;
}

std::string oldest_text(const Revocation& revocation) {
  return std::to_string(revocation.oldest_accepted);
}

/// One for each of the two that was taken.
std::vector<AuditEntry> entries_of(const Revocation& revocation) {
  std::vector<AuditEntry> entries;
  if (revocation.revoked)
    entries.push_back(entry_of(kRevoke, revocation.client, time_text(*revocation.revoked)));
  if (revocation.oldest_accepted > 1)
    entries.push_back(entry_of(kReplace, revocation.client, oldest_text(revocation)));
  return entries;
}

std::optional<Revocation> revocation_of(const AuditEntry& entry) {
  Revocation revocation{.client = entry.target};
  if (entry.verb == kRevoke) {
    revocation.revoked = std::chrono::floor<std::chrono::seconds>(
        std::chrono::sys_time<std::chrono::milliseconds>(std::chrono::milliseconds(entry.time_ms)));
    return revocation;
  }
  const char* const end = entry.after.data() + entry.after.size();
  const auto read = std::from_chars(entry.after.data(), end, revocation.oldest_accepted);
  if (entry.verb != kReplace || read.ec != std::errc() || read.ptr != end)
    return std::nullopt;
  return revocation;
}

/// What a record lacked that is written into it again.
std::string lost_text(const Revocation& revocation) {
  return revocation.revoked
             ? "revoked at " + time_text(*revocation.revoked)
             : "credentials before number " + oldest_text(revocation) + " are refused";
}

}  // namespace

RevocationWatch::RevocationWatch(security::SecurityFolder folder,
                                 security::ClientDirectory& clients, store::Store& store,
                                 std::function<void(std::string_view)> warn)
    : folder_(std::move(folder)), clients_(clients), store_(store), warn_(std::move(warn)) {
  read_log();
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

RevocationWatch::~RevocationWatch() = default;

void RevocationWatch::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    try {
      look();
    } catch (const std::exception&) {  // the store's status says why; the next look tries again
    }
    std::unique_lock lock(mutex_);
    stopping_.wait_for(lock, stop, kInterval, [] { return false; });
  }
}

void RevocationWatch::look() {
  const auto now = std::chrono::steady_clock::now();
  const bool is_due = now - read_at_ >= kReadInterval;
  if (is_due && store_.is_shared())
    read_log();  // another server may have learned of one
  std::error_code ignored;
  const auto changed = std::filesystem::last_write_time(folder_.clients(), ignored);
  if (is_due || changed != folder_changed_) {
    const security::ClientDirectory::Differences differences = clients_.compare_records();
    for (const Revocation& revocation : differences.unknown) {
      clients_.remember(revocation);
      for (AuditEntry& entry : entries_of(revocation))
        unwritten_.push_back(std::move(entry));
    }
    revoke_again(differences.put_back);
    folder_changed_ = changed;
    read_at_ = now;
  }
  write_log();
}

void RevocationWatch::read_log() {
  constexpr std::size_t kPage = 1000;
  std::string cursor;
  do {
    const store::Page<AuditEntry> page = store_.list_audit(security::kServerName, cursor, kPage);
    for (const AuditEntry& entry : page.rows)
      if (const auto revocation = revocation_of(entry))
        clients_.remember(*revocation);
    cursor = page.next_cursor;
  } while (!cursor.empty());
}

void RevocationWatch::write_log() {
  while (!unwritten_.empty()) {
    store_.add_audit(unwritten_.front());
    unwritten_.erase(unwritten_.begin());
  }
}

void RevocationWatch::revoke_again(const std::vector<Revocation>& put_back) {
  std::set<std::string> told;
  for (const Revocation& revocation : put_back) {
    AuditEntry entry = entry_of(kRevokeAgain, revocation.client, lost_text(revocation));
    entry.before = "its record was put back";
    try {
      folder_.revoke_again(revocation);
    } catch (const Failure& failure) {
      entry.message = std::string("refused, but its record stays: ") + failure.what();
      told.insert(revocation.client);
    }
    if (told_.contains(revocation.client))
      continue;
    warn_("client '" + revocation.client + "': its record was put back; " + entry.after +
          (entry.message.empty() ? "" : "; " + entry.message));
    unwritten_.push_back(std::move(entry));
  }
  told_ = std::move(told);
}

}  // namespace kinship::app
