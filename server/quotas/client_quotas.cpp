#include "server/quotas/client_quotas.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/number_text.hpp"

namespace kinship::quotas {
namespace {

using std::chrono::milliseconds;

constexpr double kDay_s = 86'400;
constexpr double kBurst_s = 10;  // of quotas by the second
constexpr double kMeter_s = 60;
constexpr milliseconds kShortestRetry{100};

Rate by_the_second(double per_s) { return {per_s, kBurst_s * per_s}; }
Rate by_the_day(double per_day) { return {per_day / kDay_s, per_day}; }

milliseconds retry_in(std::chrono::duration<double> time) {
  const double longest = static_cast<double>(kMaxRetryAfter_ms);
  return std::max(kShortestRetry,
                  milliseconds(std::lround(std::min(1000 * time.count(), longest))));
}

/// The name of a quota's amount, and the option that sets it.
struct Wording {
  std::string_view what, option;
  double unit;  // of the option
};

Wording wording_of(Quota quota) {
  switch (quota) {
    case Quota::Attempts:
      return {"attempts a second", "--client-attempts-per-s", 1};
    case Quota::Bytes:
      return {"MB a second", "--client-mb-per-s", 1e6};
    case Quota::Robots:
      return {"new robots a day", "--client-robots-per-day", 1};
    case Quota::Tasks:
      return {"new tasks a day", "--client-tasks-per-day", 1};
    default:
      return {"MB of paths a day", "--client-stored-mb-per-day", 1e6};
  }
}

}  // namespace

void ClientQuotas::Meter::decay(double passed_s) { amount *= std::exp(-passed_s / kMeter_s); }

double ClientQuotas::Meter::per_s() const { return amount / kMeter_s; }

ClientQuotas::Entry::Entry(std::string name, const std::array<Rate, kBuckets>& rates, TimePoint now)
    : client(std::move(name)),
      buckets{TokenBucket(rates[0], now), TokenBucket(rates[1], now), TokenBucket(rates[2], now),
              TokenBucket(rates[3], now), TokenBucket(rates[4], now)},
      metered(now),
      seen(now) {
  use.client = client;
}

ClientQuotas::ClientQuotas(const runtime::Clock& clock, const ClientRates& rates)
    : clock_(clock),
      rates_{by_the_second(rates.attempts_per_s), by_the_second(rates.bytes_per_s),
             by_the_day(rates.robots_per_day), by_the_day(rates.tasks_per_day),
             by_the_day(rates.stored_bytes_per_day)},
      max_clients_(std::max<std::size_t>(rates.max_clients, 1)) {}

std::size_t ClientQuotas::bucket_of(Quota quota) {
  switch (quota) {
    case Quota::Attempts:
      return 0;
    case Quota::Bytes:
      return 1;
    case Quota::Robots:
      return 2;
    case Quota::Tasks:
      return 3;
    default:
      return 4;
  }
}

std::optional<Refusal> ClientQuotas::admit(const std::string& client, std::size_t bytes,
                                           std::size_t attempts) {
  if (client.empty())
    return std::nullopt;
  const TimePoint now = clock_.now();
  const std::lock_guard lock(mutex_);
  Entry& entry = find(client, now);
  ++entry.use.requests;
  const auto amount = static_cast<double>(attempts);
  if (auto refusal = over(entry, Quota::Bytes, static_cast<double>(bytes), now))
    return refusal;
  if (attempts > 0) {
    if (auto refusal = over(entry, Quota::Attempts, amount, now))
      return refusal;
    if (auto refusal = over(entry, Quota::Stored, 1, now))  // how much it will be is not known
      return refusal;
  }
  entry.buckets[bucket_of(Quota::Attempts)].take(rate_of(Quota::Attempts), amount, now);
  entry.buckets[bucket_of(Quota::Bytes)].take(rate_of(Quota::Bytes), static_cast<double>(bytes),
                                              now);
  entry.use.attempts += attempts;
  meter(entry, attempts, bytes, now);
  return std::nullopt;
}

std::optional<Refusal> ClientQuotas::may_add(const std::string& client, Quota quota) {
  if (client.empty())
    return std::nullopt;
  const TimePoint now = clock_.now();
  const std::lock_guard lock(mutex_);
  return over(find(client, now), quota, 1, now);
}

void ClientQuotas::count_reply(const std::string& client, std::size_t bytes) {
  if (client.empty())
    return;
  const TimePoint now = clock_.now();
  const std::lock_guard lock(mutex_);
  Entry& entry = find(client, now);
  entry.buckets[bucket_of(Quota::Bytes)].take(rate_of(Quota::Bytes), static_cast<double>(bytes),
                                              now);
  meter(entry, 0, bytes, now);
}

void ClientQuotas::count_robot(const std::string& client, const std::string& label, bool is_new) {
  if (client.empty())
    return;
  const TimePoint now = clock_.now();
  const std::lock_guard lock(mutex_);
  Entry& entry = find(client, now);
  if (is_new) {
    entry.buckets[bucket_of(Quota::Robots)].take(rate_of(Quota::Robots), 1, now);
    ++entry.use.registered_robots;
  }
  std::vector<std::string>& labels = entry.use.robots;
  std::erase(labels, label);
  if (labels.size() == kMaxLabelsOfClient)
    labels.erase(labels.begin());
  labels.push_back(label);
}

void ClientQuotas::count_task(const std::string& client) {
  if (client.empty())
    return;
  const TimePoint now = clock_.now();
  const std::lock_guard lock(mutex_);
  Entry& entry = find(client, now);
  entry.buckets[bucket_of(Quota::Tasks)].take(rate_of(Quota::Tasks), 1, now);
  ++entry.use.created_tasks;
}

void ClientQuotas::count_stored(const std::string& client, std::size_t bytes) {
  if (client.empty())
    return;
  const TimePoint now = clock_.now();
  const std::lock_guard lock(mutex_);
  Entry& entry = find(client, now);
  entry.buckets[bucket_of(Quota::Stored)].take(rate_of(Quota::Stored), static_cast<double>(bytes),
                                               now);
  entry.use.stored_bytes += bytes;
}

void ClientQuotas::count_refusal(const std::string& client, Quota quota) {
  ++refusals_[static_cast<std::size_t>(quota)];
  if (client.empty())
    return;
  const TimePoint now = clock_.now();
  const std::lock_guard lock(mutex_);
  ClientUse& use = find(client, now).use;
  ++use.refused;
  use.refused_for = kQuotaNames[static_cast<std::size_t>(quota)];
}

void ClientQuotas::count_bad_request(const std::string& client) {
  if (client.empty())
    return;
  const TimePoint now = clock_.now();
  const std::lock_guard lock(mutex_);
  ++find(client, now).use.bad_requests;
}

void ClientQuotas::describe(const std::string& client, const std::string& host,
                            const std::string& program) {
  if (client.empty() || (host.empty() && program.empty()))
    return;
  const TimePoint now = clock_.now();
  const std::lock_guard lock(mutex_);
  Entry& entry = find(client, now);
  if (entry.client != client)  // it shares the quotas of others
    return;
  entry.use.host = host;
  entry.use.program = program;
}

std::vector<ClientUse> ClientQuotas::list() const {
  const TimePoint now = clock_.now();
  std::vector<ClientUse> rows;
  {
    const std::lock_guard lock(mutex_);
    rows.reserve(entries_.size());
    for (const Entry& entry : entries_) {
      Entry copy = entry;
      meter(copy, 0, 0, now);
      copy.use.attempts_per_s = copy.attempts.per_s();
      copy.use.bytes_per_s = copy.bytes.per_s();
      rows.push_back(std::move(copy.use));
    }
  }
  std::ranges::stable_sort(
      rows, [](const ClientUse& a, const ClientUse& b) { return a.bytes_per_s > b.bytes_per_s; });
  return rows;
}

std::size_t ClientQuotas::size() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

/// The client's entry, which is the newest then; of the others' if there is no room for it.
ClientQuotas::Entry& ClientQuotas::find(const std::string& client, TimePoint now) {
  auto place = places_.find(client);
  if (place == places_.end() && (entries_.size() < max_clients_ || forget_idle(now)))
    return *make(client, now);
  if (place == places_.end()) {
    const std::string others(kOthers);
    place = places_.find(others);
    if (place == places_.end())
      return *make(others, now);  // one more than max_clients_
  }
  entries_.splice(entries_.begin(), entries_, place->second);
  Entry& entry = entries_.front();
  entry.seen = now;
  entry.use.last_seen_ms = clock_.unix_ms();
  return entry;
}

ClientQuotas::Entries::iterator ClientQuotas::make(const std::string& client, TimePoint now) {
  entries_.emplace_front(client, rates_, now);
  entries_.front().use.last_seen_ms = clock_.unix_ms();
  places_.emplace(client, entries_.begin());
  return entries_.begin();
}

/// Whether an entry made room: its quotas are whole again, so nothing is given away.
bool ClientQuotas::forget_idle(TimePoint now) {
  constexpr int kMostLooked = 64;  // from the oldest on: a flood costs no more than that
  auto entry = entries_.end();
  for (int i = 0; i < kMostLooked && entry != entries_.begin(); ++i) {
    --entry;
    if (now - entry->seen < kIdle)
      return false;
    bool is_whole = true;
    for (std::size_t bucket = 0; bucket < kBuckets; ++bucket)
      is_whole = is_whole && entry->buckets[bucket].is_full(rates_[bucket], now);
    if (!is_whole)
      continue;
    places_.erase(entry->client);
    entries_.erase(entry);
    return true;
  }
  return false;
}

void ClientQuotas::meter(Entry& entry, std::size_t attempts, std::size_t bytes,
                         TimePoint now) const {
  const double passed_s = std::chrono::duration<double>(now - entry.metered).count();
  entry.metered = now;
  entry.attempts.decay(passed_s);
  entry.bytes.decay(passed_s);
  entry.attempts.amount += static_cast<double>(attempts);
  entry.bytes.amount += static_cast<double>(bytes);
}

std::optional<Refusal> ClientQuotas::over(Entry& entry, Quota quota, double amount, TimePoint now) {
  const Rate& rate = rate_of(quota);
  const auto time = entry.buckets[bucket_of(quota)].time_until(rate, amount, now);
  if (time.count() <= 0)
    return std::nullopt;
  ++refusals_[static_cast<std::size_t>(quota)];
  ++entry.use.refused;
  entry.use.refused_for = kQuotaNames[static_cast<std::size_t>(quota)];
  const Wording words = wording_of(quota);
  const double limit = (bucket_of(quota) < 2 ? rate.per_s : rate.burst) / words.unit;
  const milliseconds retry = retry_in(time);
  std::string message = "busy: client '" + entry.client + "' is over its quota of " +
                        number_text(limit) + " " + std::string(words.what) + " (kinshipd " +
                        std::string(words.option) + "); again in " +
                        number_text(static_cast<double>(retry.count()) / 1000) + " s";
  return Refusal{quota, retry, std::move(message)};
}

}  // namespace kinship::quotas
