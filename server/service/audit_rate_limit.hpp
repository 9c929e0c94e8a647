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

/// How many entries of what was not done each client may have in the audit log: so many at once,
/// and one a second from then on. Whoever is refused may ask for ever, and nothing is ever taken
/// out of the log; nor may one client's refusals hide another's. May be shared between threads.
class AuditRateLimit {
 public:
  static constexpr std::uint64_t kAtOnce = 100;
  /// That are told apart. While none of them has all of its allowance back, newcomers share one.
  static constexpr std::size_t kClients = 256;

  /// \param clock  outlives it.
  explicit AuditRateLimit(const runtime::Clock& clock) : clock_(clock) {}

  /// Takes one. \return how many of the client's were left out since its last one; nothing if this
  /// one is left out, too.
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
  // By client; "" is of nobody in particular, and of those for whom there is no place.
  std::map<std::string, Entry> entries_;
};

}  // namespace kinship::service
