#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "proto/types/client_use.hpp"
#include "server/quotas/quota.hpp"
#include "server/runtime/clock.hpp"

namespace kinship::quotas {

/// Measures the use of the server by each client and enforces quotas. Clients are distinguished by
/// the identity from the network layer (Caller::client), up to a maximum number: then a client that
/// has been idle for a minute, with all of its quotas restored, makes room. If none has, new
/// clients share the quotas of one client, so that invented identities gain nothing and cost no
/// memory. May be shared between threads.
///
/// The empty client is the server itself: it has no quotas and is not counted.
class ClientQuotas {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// The client under which new clients are counted when all places are taken.
  static constexpr std::string_view kOthers = "(others)";
  static constexpr std::chrono::seconds kIdle{60};  ///< after it a client may make room

  /// \param clock  outlives it.
  ClientQuotas(const runtime::Clock& clock, const ClientRates& rates);

  /// Whether a request is admitted; then it is counted.
  /// \param bytes, attempts  of the request.
  std::optional<Refusal> admit(const std::string& client, std::size_t bytes, std::size_t attempts);

  /// Whether a robot may be registered, or a task begun, now. Takes nothing: count_robot() and
  /// count_task() do.
  std::optional<Refusal> may_add(const std::string& client, Quota quota);

  void count_reply(const std::string& client, std::size_t bytes);
  void count_robot(const std::string& client, const std::string& label, bool is_new);
  void count_task(const std::string& client);
  void count_stored(const std::string& client, std::size_t bytes);
  /// Counts a refusal for a quota that is enforced elsewhere.
  void count_refusal(const std::string& client, Quota quota);

  /// Counts a request of an administrator that named nothing, or broke a rule.
  void count_bad_request(const std::string& client);
  /// Takes over what a client says of itself; nothing if it says nothing.
  void describe(const std::string& client, const std::string& host, const std::string& program);

  /// All counted clients, those with the most bytes in the last minute first, then the last seen.
  /// Their current numbers (on_way, waiting, leases, fits) are left at 0.
  std::vector<ClientUse> list() const;

  std::size_t size() const;
  std::uint64_t refusals(Quota quota) const noexcept {
    return refusals_[static_cast<std::size_t>(quota)];
  }

 private:
  static constexpr std::size_t kBuckets = 5;

  /// A mean over about a minute, with exponentially decaying weights.
  struct Meter {
    double amount = 0;
    void decay(double passed_s);
    double per_s() const;
  };
  struct Entry {
    Entry(std::string name, const std::array<Rate, kBuckets>& rates, TimePoint now);

    std::string client;
    std::array<TokenBucket, kBuckets> buckets;
    Meter attempts, bytes;
    TimePoint metered, seen;
    ClientUse use;
  };
  using Entries = std::list<Entry>;

  // With the lock held.
  Entry& find(const std::string& client, TimePoint now);
  Entries::iterator make(const std::string& client, TimePoint now);
  bool forget_idle(TimePoint now);
  void meter(Entry& entry, std::size_t attempts, std::size_t bytes, TimePoint now) const;
  std::optional<Refusal> over(Entry& entry, Quota quota, double amount, TimePoint now);
  const Rate& rate_of(Quota quota) const { return rates_[bucket_of(quota)]; }
  static std::size_t bucket_of(Quota quota);

  const runtime::Clock& clock_;
  const std::array<Rate, kBuckets> rates_;
  const std::size_t max_clients_;
  std::array<std::atomic<std::uint64_t>, kQuotaNames.size()> refusals_{};

  mutable std::mutex mutex_;  // guards what follows
  Entries entries_;           // the last seen comes first
  std::unordered_map<std::string, Entries::iterator> places_;
};

}  // namespace kinship::quotas
