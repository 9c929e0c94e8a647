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

/// Who takes how much of the server, and whether one may have more. Clients are told apart by what
/// the network layer says they are (Caller::client), up to a number of them: then who has taken
/// nothing for a minute, and has all of its quotas back, makes room. While there is none, newcomers
/// share the quotas of one client, so that who invents identities wins nothing by it and costs no
/// memory. May be shared between threads.
///
/// The empty client is the server itself: it has no quotas and is not counted.
class ClientQuotas {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// What newcomers are counted as when all places are taken.
  static constexpr std::string_view kOthers = "(others)";
  static constexpr std::chrono::seconds kIdle{60};  ///< then a client may make room

  /// \param clock  outlives it.
  ClientQuotas(const runtime::Clock& clock, const ClientRates& rates);

  /// Whether a request may come in; then it is counted.
  /// \param bytes, attempts  that it has.
  std::optional<Refusal> admit(const std::string& client, std::size_t bytes, std::size_t attempts);

  /// Whether a robot may be registered, or a task begun. Taken once it was: the answer is for now.
  std::optional<Refusal> may_add(const std::string& client, Quota quota);

  void count_reply(const std::string& client, std::size_t bytes);
  void count_robot(const std::string& client, const std::string& label, bool is_new);
  void count_task(const std::string& client);
  void count_stored(const std::string& client, std::size_t bytes);
  /// Something else said that a client has enough.
  void count_refusal(const std::string& client, Quota quota);

  /// All that are counted, who took most in the last minute first; then who was seen last. What
  /// they have at a time (on_way, waiting, leases, fits) is left at 0.
  std::vector<ClientUse> list() const;

  std::size_t size() const;
  std::uint64_t refusals(Quota quota) const noexcept {
    return refusals_[static_cast<std::size_t>(quota)];
  }

 private:
  static constexpr std::size_t kBuckets = 5;

  /// A mean over about a minute: what was taken counts less the longer ago it was.
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
  Entries entries_;           // who was seen last comes first
  std::unordered_map<std::string, Entries::iterator> places_;
};

}  // namespace kinship::quotas
