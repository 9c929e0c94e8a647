#include "server/app/revocation_watch.hpp"

#include <algorithm>
#include <charconv>
#include <ctime>
#include <exception>
#include <iterator>
#include <optional>
#include <sstream>
#include <utility>

#include "proto/security/credentials.hpp"
#include "proto/types/time_text.hpp"
#include "server/store/values/audit_texts.hpp"

namespace kinship::app {
namespace {

using security::Revocation;

// Acts in the audit log by the name that no client can have. `before` has the fingerprint of the
// issuing authority.
constexpr const char* kRevoke = "revoke";
constexpr const char* kReplace = "replace_credentials";
constexpr const char* kIssue = "issue_credentials";
constexpr const char* kRevokeAgain = "revoke_again";
constexpr const char* kTrust = "trust_authorities";

AuditEntry entry_of(const char* verb, const std::string& target, const std::string& before,
                    const std::string& after) {
  AuditEntry entry = store::entry_of_maintenance(verb, target, before, after);
  entry.name = security::kServerName;
  return entry;
}

/// One for each that is to be kept.
std::vector<AuditEntry> entries_of(const Revocation& revocation, const std::string& authority) {
  std::vector<AuditEntry> entries;
  const auto add = [&](const char* verb, const std::string& after) {
    entries.push_back(entry_of(verb, revocation.client, authority, after));
  };
  if (revocation.revoked)
    add(kRevoke, time_text(*revocation.revoked));
  if (revocation.oldest_accepted > 1)
    add(kReplace, std::to_string(revocation.oldest_accepted));
  if (revocation.generation > 1)
    add(kIssue, std::to_string(revocation.generation));
  return entries;
}

std::optional<std::chrono::sys_seconds> read_time(const std::string& text) {
  std::tm fields{};
  const char* const rest = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%SZ", &fields);
  if (rest == nullptr || *rest != 0)
    return std::nullopt;
  return std::chrono::sys_seconds(std::chrono::seconds(timegm(&fields)));
}

std::chrono::sys_seconds written_at(const AuditEntry& entry) {
  return std::chrono::sys_seconds(
      std::chrono::floor<std::chrono::seconds>(std::chrono::milliseconds(entry.time_ms)));
}

std::optional<std::uint32_t> read_number(const std::string& text) {
  std::uint32_t number = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  if (read.ec != std::errc() || read.ptr != end)
    return std::nullopt;
  return number;
}

/// \return nothing if the entry is about something else.
std::optional<Revocation> revocation_of(const AuditEntry& entry) {
  Revocation revocation{.client = entry.target};
  if (entry.verb == kRevoke)  // also if its time cannot be read
    revocation.revoked = read_time(entry.after).value_or(written_at(entry));
  else if (entry.verb == kReplace)
    revocation.oldest_accepted = read_number(entry.after).value_or(1);
  else if (entry.verb == kIssue)
    revocation.generation = read_number(entry.after).value_or(1);
  else
    return std::nullopt;
  return revocation;
}

/// What a record lacked that is written into it again.
std::string lost_text(const Revocation& revocation) {
  if (revocation.revoked)
    return "revoked at " + time_text(*revocation.revoked);
  if (revocation.oldest_accepted > 1)
    return "credentials before number " + std::to_string(revocation.oldest_accepted) +
           " are refused";
  return "credentials up to number " + std::to_string(revocation.generation) + " were issued";
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

}  // namespace

RevocationWatch::RevocationWatch(security::SecurityFolder folder,
                                 security::ClientDirectory& clients, store::Store& store,
                                 std::function<void(std::string_view)> warn)
    : folder_(std::move(folder)), clients_(clients), store_(store), warn_(std::move(warn)) {
  const std::vector<std::string> trusted = folder_.authorities();
  authorities_.insert(trusted.begin(), trusted.end());
  std::string text;
  for (const std::string& one : trusted)
    text += (text.empty() ? "" : " ") + one;
  const std::vector<AuditEntry> entries = read_log();
  if (std::ranges::none_of(entries, [&](const AuditEntry& entry) {
        return entry.verb == kTrust && entry.target == text;
      }))
    unwritten_.push_back(entry_of(kTrust, text, "", ""));
  try {
    write_log();
  } catch (const Failure&) {  // a full disk keeps no server from starting; it is tried again
  }
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
  compare_records();  // needs no store
  write_log();
  const auto now = std::chrono::steady_clock::now();
  if (store_.is_shared() && now - read_at_ >= kLongInterval) {
    read_log();  // another server may have learned of one
    read_at_ = now;
  }
}

void RevocationWatch::compare_records() {
  const auto now = std::chrono::steady_clock::now();
  std::error_code ignored;
  const auto changed = std::filesystem::last_write_time(folder_.clients(), ignored);
  if (now - compared_at_ < kLongInterval && changed == folder_changed_)
    return;
  const security::ClientDirectory::Differences differences = clients_.compare_records();
  const std::string authority = folder_.authorities().front();
  for (const Revocation& revocation : differences.unknown) {
    for (AuditEntry& entry : entries_of(revocation, authority))
      unwritten_.push_back(std::move(entry));
    clients_.remember(revocation);
  }
  revoke_again(differences.put_back);
  folder_changed_ = changed;
  compared_at_ = now;
}

/// Authorities that were ever trusted together are one folder's, one after the other.
std::vector<AuditEntry> RevocationWatch::read_log() {
  constexpr std::size_t kPage = 1000;
  std::vector<AuditEntry> entries;
  std::string cursor;
  do {
    store::Page<AuditEntry> page = store_.list_audit(security::kServerName, cursor, kPage);
    std::ranges::move(page.rows, std::back_inserter(entries));
    cursor = page.next_cursor;
  } while (!cursor.empty());
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (const AuditEntry& entry : entries) {
      const std::vector<std::string> together = words_of(entry.target);
      if (entry.verb == kTrust && std::ranges::any_of(together, [this](const std::string& one) {
            return authorities_.contains(one);
          }))
        for (const std::string& one : together)
          has_grown |= authorities_.insert(one).second;
    }
  }
  for (const AuditEntry& entry : entries)
    if (const auto revocation = revocation_of(entry);
        revocation && authorities_.contains(entry.before))
      clients_.remember(*revocation);
  return entries;
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
    AuditEntry entry =
        entry_of(kRevokeAgain, revocation.client, "its record was put back", lost_text(revocation));
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
