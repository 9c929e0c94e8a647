#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "server/quotas/token_bucket.hpp"
#include "server/runtime/clock.hpp"

namespace kinship::service {

/// Limits the entries of refused and failed requests that each client may have in the audit log: a
/// burst, then one per second. A refused client may ask for ever, and entries are never removed
/// from the log; nor may one client's refusals hide another's. May be shared between threads.
class AuditRateLimit {
 public:
  static constexpr std::uint64_t kAtOnce = 100;
  /// Clients with a bucket of their own. While none of these buckets is full again, new clients
  /// share one.
  static constexpr std::size_t kClients = 256;

  /// \param clock  outlives it.
  explicit AuditRateLimit(const runtime::Clock& clock) : clock_(clock) {}

  /// Takes one entry. \return number of the client's entries left out since its last one; nothing
  /// if this one is left out, too.
  std::optional<std::uint64_t> take(const std::string& client);

 private:
  static constexpr quotas::Rate kRate{.per_s = 1, .burst = kAtOnce};
  struct Entry {
    quotas::TokenBucket bucket;
    std::uint64_t left_out = 0;
  };

  Entry& entry_of(const std::string& client, quotas::TokenBucket::TimePoint now);

  const runtime::Clock& clock_;
  std::mutex mutex_;  // guards what follows
  // By client; "" is for requests without a client, and for clients without a place.
  std::map<std::string, Entry> entries_;
};

}  // namespace kinship::service
