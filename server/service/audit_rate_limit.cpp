#include "server/service/audit_rate_limit.hpp"

#include <iterator>
#include <utility>

namespace kinship::service {

std::optional<std::uint64_t> AuditRateLimit::take(const std::string& client) {
  const std::lock_guard lock(mutex_);
  const auto now = clock_.now();
  Entry& entry = entry_of(client, now);
  if (entry.bucket.time_until(kRate, 1, now).count() > 0) {
    ++entry.left_out;
    return std::nullopt;
  }
  entry.bucket.take(kRate, 1, now);
  return std::exchange(entry.left_out, 0);
}

AuditRateLimit::Entry& AuditRateLimit::entry_of(const std::string& client,
                                                quotas::TokenBucket::TimePoint now) {
  const auto found = entries_.find(client);
  if (found != entries_.end())
    return found->second;
  // The number left out of a quiet client is forgotten with it: else invented clients could take
  // all places for good.
  if (entries_.size() >= kClients)
    for (auto each = entries_.begin(); each != entries_.end();)
      each = each->second.bucket.is_full(kRate, now) ? entries_.erase(each) : std::next(each);
  const std::string& name = entries_.size() < kClients ? client : std::string();
  return entries_.try_emplace(name, Entry{quotas::TokenBucket(kRate, now)}).first->second;
}

}  // namespace kinship::service
